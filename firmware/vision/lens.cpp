#include "vision/lens.hpp"

#include <Eigen/LU>
#include <cmath>

#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

// Errors of one point are alike from view to view, so they tell less than their number promises.
constexpr double kNoise_px = 2.0;
constexpr double kMemory = 0.98;           // of a window for the next one: a lens changes slowly
constexpr double kWindowShare = 1.0 / 15;  // of a window's pictures that the next one lacks
// A window contradicts the calibration of k1 or readout if it sees them this many of its sigmas away, and sees them
// this much better than the prior. Measured with kNoise_px: up to 1 where the calibration is right, 4 and more where
// not.
constexpr double kContradiction = 3.0;
constexpr double kClear = 3.0;
constexpr double kSettled_k1 = 0.001, kSettled_s = 0.001;  // steps that hardly show: 0.2 px in the corner
constexpr double kHeld = 1e12;                             // information of what must not move, px^2

double information_of(double sigma) { return sigma > 0.0 ? kNoise_px * kNoise_px / (sigma * sigma) : kHeld; }

}  // namespace

Twist twist_between(const ViewPose& earlier, const ViewPose& later, double seconds) {
  if (!(seconds > 0.0)) return {};
  const ViewPose step = relative(later, earlier);
  return {so3_log(step.R_C_V) / seconds, step.t_C_V / seconds};
}

Eigen::Vector2d image_flow_s(const Eigen::Vector3d& p_C, const Twist& twist) {
  const Eigen::Vector3d moving = twist.omega_rad_s.cross(p_C) + twist.v_s;
  return (moving.head<2>() - p_C.hnormalized() * moving.z()) / p_C.z();
}

Eigen::Vector2d d_unproject_d_k1(const CameraModel& camera, const Eigen::Vector2d& n) {
  return -distort_jacobian(camera, n).partialPivLu().solve(distort_d_k1(camera, n));
}

Lens::Lens(const CameraModel& calibrated, const LensPrior& prior)
    : camera_(calibrated),
      prior_(k1_of(calibrated), prior.readout_s),
      value_(prior_),
      carried_(prior_),
      free_(prior.k1_sigma > 0.0 || prior.readout_sigma_s > 0.0) {
  prior_information_.diagonal() << information_of(prior.k1_sigma), information_of(prior.readout_sigma_s);
}

Eigen::Vector2d Lens::at_stamp(const Eigen::Vector2d& normalised, double y_px, const Eigen::Vector3d& p_C,
                               const Twist& twist) const {
  if (readout_s() == 0.0 || p_C.z() <= kMinDepth) return normalised;
  return normalised - row_share(camera_, y_px) * readout_s() * image_flow_s(p_C, twist);
}

LensJacobian Lens::d_at_stamp(const Eigen::Vector2d& normalised, double y_px, const Eigen::Vector3d& p_C,
                              const Twist& twist) const {
  LensJacobian J;
  J.col(0) = d_unproject_d_k1(camera_, normalised);
  J.col(1).setZero();
  if (p_C.z() > kMinDepth) J.col(1) = -row_share(camera_, y_px) * image_flow_s(p_C, twist);
  return J;
}

LensMatrix Lens::information() const {
  LensMatrix result = prior_information_ + carried_information_;
  for (int i = 0; i < 2; ++i) {
    if (!shown_[i]) result(i, i) += kHeld;
  }
  return result;
}

LensVector Lens::expected_step() const {
  const LensMatrix known = prior_information_ + carried_information_;
  LensVector step = known.ldlt().solve(prior_information_ * prior_ + carried_information_ * carried_) - value_;
  for (int i = 0; i < 2; ++i) {
    if (!shown_[i]) step(i) = 0.0;
  }
  return step;
}

LensMatrix Lens::covariance() const {
  LensMatrix known = prior_information_ + carried_information_;
  for (int i = 0; i < 2; ++i) {
    if (seen_[i] && !shown_[i]) known(i, i) += kHeld;
  }
  return kNoise_px * kNoise_px * known.inverse();
}

void Lens::judge(int i, const LensMatrix& information, const LensVector& pull) {
  const double prior_sigma = kNoise_px / std::sqrt(prior_information_(i, i));
  if (!(information.determinant() > 0.0) || !(information(i, i) > 0.0)) return;
  const LensMatrix covariance = information.inverse();
  const double sigma = kNoise_px * std::sqrt(covariance(i, i));
  const double off = value_(i) + (covariance * pull)(i)-prior_(i);
  if (!(sigma < prior_sigma / kClear)) return;
  seen_[i] = true;
  shown_[i] = shown_[i] || std::abs(off) > kContradiction * sigma;
}

void Lens::learn(const LensVector& step, const LensMatrix& window_information, const LensVector& window_pull) {
  ++windows_;
  value_ += step;
  set_k1(camera_, value_(0));
  settling_ = std::abs(step(0)) > kSettled_k1 || std::abs(step(1)) > kSettled_s;
  for (int i = 0; i < 2; ++i) {
    const bool before = shown_[i];
    judge(i, window_information, window_pull);
    settling_ = settling_ || shown_[i] != before;
  }
  if (!shown_[0] && !shown_[1]) return;
  const LensMatrix old = kMemory * carried_information_, fresh = kWindowShare * window_information;
  carried_information_ = old + fresh;
  if (carried_information_.determinant() > 0.0) {
    carried_ = carried_information_.ldlt().solve(old * carried_ + fresh * value_);
  }
}

}  // namespace rfmvo
