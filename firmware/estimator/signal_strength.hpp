// Signal strength as weak evidence of where a tag is: how a read's RSSI should fall with distance and off
// the beam. Far too coarse to locate a tag by, it tells positions apart that the phases cannot
// (an interferometer's lobes, front from back). docs/estimator.md, section 5.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimator/joint_problem.hpp"

namespace rfmvo {

struct BeamModel {
  std::vector<Eigen::Vector3d> boresight_C;  // per port, unit vectors
  std::vector<double> gain_db;               // per port, there and back, against the mean of all; empty: all alike
  double range_max_m = 5.0;                  // of a read
  double half_power_rad = 0.61;              // off boresight (half of the beam's full width)
  double fading_db = 5.0;                    // 1 sigma of RSSI about the model: multipath, cartons
  double fading_length_m = 0.25;             // antenna travel between independent fades
  // What the tags of this site are like, one against the other: the constant of a typical one (unknown: any constant
  // will do) and how tags differ from it, 1 sigma (make, orientation, what they stick on).
  std::optional<double> level_db;
  double level_sigma_db = 6.0;
};

// Power there and back relative to boresight, dB: cos^n, n such that one way is half at half_power_rad;
// not below -30 dB.
[[nodiscard]] double two_way_pattern_db(double cosine, double half_power_rad);

// RSSI to be expected of a read, up to a constant of the tag, dB.
[[nodiscard]] double expected_rssi_db(const JointRead& read, const JointState& state, const BeamModel& beams,
                                      const Eigen::Vector3d& p_W_X);

// The constant (tag sensitivity, orientation) with which one tag's RSSI suits a position best, and -ln likelihood of the
// RSSI then: Student's t of 4 degrees of freedom per independent fade, and one for the constant if the site's is known.
struct SignalFit {
  double cost = 0.0, level_db = 0.0;
};
[[nodiscard]] SignalFit fit_signal_strength(const std::vector<JointRead>& reads, const JointState& state,
                                            const BeamModel& beams, const Eigen::Vector3d& p_W_X);
[[nodiscard]] double signal_strength_cost(const std::vector<JointRead>& reads, const JointState& state,
                                          const BeamModel& beams, const Eigen::Vector3d& p_W_X);

}  // namespace rfmvo
