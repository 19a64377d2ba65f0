// What a bound is of: the reads of a run, where everything truly was, and what the errors truly were.
// From the simulator; shares nothing with the estimator.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "base/result.hpp"
#include "geometry/rigid.hpp"
#include "rf/epc.hpp"
#include "simulate/drift.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::bound {

struct Read {
  double t_s = 0.0;
  std::size_t tag = 0, port = 0;
  double frequency_hz = 920e6;
  double white_rad = 0.1;  // 1 sigma, of this read alone
  double arc_m = 0.0;      // way that the antenna has travelled
};

// Phase error shared by the reads of one (tag, port): variance sigma^2, correlation over the antenna's way.
struct StructuredError {
  double sigma_rad = 0.3;
  double length_m = 0.08;
  bool exponential = false;  // exp(-s / l); else the simulator's exp(-s^2 / (2 l^2))
};

struct Tag {
  Epc epc;
  Eigen::Vector3d p_S_X_m;
};

struct World {
  std::vector<Read> reads;
  std::vector<Tag> tags;
  std::vector<Eigen::Vector3d> lever_arms_C_m;                           // by port
  Eigen::Vector3d lever_arm_sigma_m = Eigen::Vector3d::Constant(0.005);  // 1 sigma of what the estimator is told
  std::function<Rigid3(double)> T_S_C;
  std::vector<double> frame_times_s;  // increasing
  StructuredError structured;
  simulate::DriftClass drift;
};

struct ReadChoice {
  std::optional<double> white_rad;       // instead of what the link says
  std::optional<double> read_spacing_m;  // instead of the inventory: each tag on each port, this often along the way
};

// Errors: as of simulate(); a frame gap (what an interrupted odometry knows is not modelled).
[[nodiscard]] Result<World> world_of(const simulate::Options& options, const ReadChoice& choice = {});

}  // namespace rfmvo::bound
