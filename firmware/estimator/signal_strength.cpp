#include "estimator/signal_strength.hpp"

#include <algorithm>
#include <cmath>

namespace rfmvo {
namespace {

constexpr double kFreedoms = 4.0;

struct Fade {
  double excess_db = 0.0;  // measured - expected
  double weight = 0.0;     // independent fades that this read stands for, at most 1
};

// A read stands for the way its antenna went since the one before it on the same port.
std::vector<Fade> fades_of(const std::vector<JointRead>& reads, const JointState& state, const BeamModel& beams,
                           const Eigen::Vector3d& p_W_X) {
  std::vector<Fade> fades;
  fades.reserve(reads.size());
  for (std::size_t i = 0; i < reads.size(); ++i) {
    const bool first = i == 0 || reads[i - 1].port != reads[i].port;
    const double way_m = first ? beams.fading_length_m : (reads[i].p_W_A - reads[i - 1].p_W_A).norm();
    fades.push_back({reads[i].rssi_db - expected_rssi_db(reads[i], state, beams, p_W_X),
                     std::min(1.0, way_m / beams.fading_length_m)});
  }
  return fades;
}

// -ln of Student's t, up to a constant.
double t_cost(double e_db, double sigma_db) {
  return 0.5 * (kFreedoms + 1.0) * std::log1p(e_db * e_db / (kFreedoms * sigma_db * sigma_db));
}

}  // namespace

double two_way_pattern_db(double cosine, double half_power_rad) {
  constexpr double kFloor_db = -30.0;  // behind the antenna: what any reflection would bring
  if (cosine <= 0.0) return kFloor_db;
  const double exponent = -std::log(2.0) / std::log(std::cos(half_power_rad));
  return std::max(kFloor_db, 20.0 * exponent * std::log10(cosine));
}

double expected_rssi_db(const JointRead& read, const JointState& state, const BeamModel& beams,
                        const Eigen::Vector3d& p_W_X) {
  const Eigen::Vector3d ray = p_W_X - antenna_position(read.geometry, states_at(read, state, TagState{}));
  const double range_m = std::max(ray.norm(), 0.05);
  const auto port = static_cast<std::size_t>(read.port);
  const double cosine = ray.dot(read.geometry.R_W_C * beams.boresight_C[port]) / range_m;
  const double gain_db = beams.gain_db.empty() ? 0.0 : beams.gain_db[port];
  return gain_db + two_way_pattern_db(cosine, beams.half_power_rad) - 40.0 * std::log10(range_m);
}

SignalFit fit_signal_strength(const std::vector<JointRead>& reads, const JointState& state, const BeamModel& beams,
                              const Eigen::Vector3d& p_W_X) {
  const std::vector<Fade> fades = fades_of(reads, state, beams, p_W_X);
  const double spread = kFreedoms * beams.fading_db * beams.fading_db;
  // The constant that suits best: a mean whose outliers lose weight as Student's t has it.
  double constant_db = 0.0;
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0.0, weights = 1e-12;
    for (const Fade& f : fades) {
      const double e = f.excess_db - constant_db;
      const double w = f.weight / (round == 0 ? 1.0 : 1.0 + e * e / spread);
      sum += w * f.excess_db;
      weights += w;
    }
    constant_db = sum / weights;
  }
  double cost = beams.level_db ? t_cost(constant_db - *beams.level_db, beams.level_sigma_db) : 0.0;
  for (const Fade& f : fades) cost += f.weight * t_cost(f.excess_db - constant_db, beams.fading_db);
  return {cost, constant_db};
}

double signal_strength_cost(const std::vector<JointRead>& reads, const JointState& state, const BeamModel& beams,
                            const Eigen::Vector3d& p_W_X) {
  return fit_signal_strength(reads, state, beams, p_W_X).cost;
}

}  // namespace rfmvo
