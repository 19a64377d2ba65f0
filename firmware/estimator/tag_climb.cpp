#include "estimator/tag_climb.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "rf/phase.hpp"

namespace rfmvo {
namespace {

constexpr double kMinDistance_m = 1e-3;  // as in phase_model
// Towards nothing in particular: keeps directions that no read sees finite.
constexpr double kWeakInformation = 1e-4;

}  // namespace

TagLikelihood::TagLikelihood(const std::vector<JointRead>& reads, const JointProblem& problem, const JointState& state,
                             double structured_sigma_rad)
    : reads_(reads),
      problem_(problem),
      conditioning_(condition_chains(reads, structured_sigma_rad, problem.structured)) {
  seen_.reserve(reads.size());
  for (const JointRead& read : reads) {
    const ReadStates s = states_at(read, state, TagState{});
    const double known = s.port_offset_rad + read.geometry.frequency_term_rad_m * s.electrical_length_m;
    seen_.push_back({antenna_position(read.geometry, s), read.geometry.wavenumber_rad_m, read.phase_rad - known});
  }
}

double TagLikelihood::best_offset_rad(const Eigen::Vector3d& p_W_X) const {
  double c = 0.0, s = 0.0;
  for (const Seen& read : seen_) {
    const double r = read.phase_rad - read.wavenumber_rad_m * (read.p_W_A - p_W_X).norm();
    c += std::cos(r);
    s += std::sin(r);
  }
  return std::atan2(s, c);
}

double TagLikelihood::share_within(double range_m, const Eigen::Vector3d& p_W_X) const {
  double within = 0.0;
  for (const Seen& read : seen_) within += (read.p_W_A - p_W_X).norm() < range_m ? 1.0 : 0.0;
  return within / static_cast<double>(seen_.size());
}

double TagLikelihood::evaluate(const Eigen::Vector3d& p_W_X, double offset_rad, Derivatives derivatives) {
  whitened_.raws.resize(seen_.size());
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Eigen::Vector3d ray = seen_[i].p_W_A - p_W_X;
    const double distance_m = std::max(ray.norm(), kMinDistance_m);
    whitened_.raws[i].residual = wrap_rad(seen_[i].phase_rad - seen_[i].wavenumber_rad_m * distance_m - offset_rad);
    if (derivatives != Derivatives::kNone) whitened_.raws[i].tag << -seen_[i].wavenumber_rad_m / distance_m * ray, 1.0;
  }
  whiten_rows(reads_, problem_, conditioning_, derivatives, whitened_);
  return whitened_.cost + 0.5 * whitened_.log_variance;
}

TagLikelihood::Maximum TagLikelihood::climb(const Eigen::Vector3d& from_W) {
  constexpr int kMaxSteps = 12;
  constexpr double kTolerance = 1e-4, kMaxLambda = 1e6;
  Maximum at{from_W, best_offset_rad(from_W), 0.0, Eigen::Matrix4d::Zero()};
  at.cost = evaluate(at.p_W_X, at.offset_rad, Derivatives::kTag);
  double lambda = 1e-3;
  for (int step = 0;; ++step) {
    Eigen::Matrix4d H = kWeakInformation * Eigen::Matrix4d::Identity();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    for (const WhitenedRow& row : whitened_.rows) {
      H.noalias() += row.weight * row.tag * row.tag.transpose();
      g.noalias() += row.weight * row.residual * row.tag;
    }
    at.covariance = H.inverse();
    if (step == kMaxSteps) return at;
    double decrease = -1.0;
    while (decrease <= 0.0 && lambda < kMaxLambda) {
      Eigen::Matrix4d damped = H;
      damped.diagonal() *= 1.0 + lambda;
      const Eigen::Vector4d d = damped.llt().solve(g);
      const double cost = evaluate(at.p_W_X + d.head<3>(), at.offset_rad + d[3], Derivatives::kTag);
      decrease = at.cost - cost;
      if (decrease > 0.0) {
        at.p_W_X += d.head<3>();
        at.offset_rad += d[3];
        at.cost = cost;
        lambda *= 0.1;
      } else {
        if (0.5 * g.dot(d) < kTolerance) return at;
        lambda *= 10.0;
      }
    }
    if (decrease < kTolerance) return at;
  }
}

}  // namespace rfmvo
