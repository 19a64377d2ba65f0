// What lies between one antenna and one tag at one moment: can it be read, how strong, what phase.
#pragma once

#include <functional>
#include <vector>

#include "simulate/scene.hpp"

namespace rfmvo::simulate {

struct LinkState {
  bool readable = false;  // enough power at the tag and back at the reader
  double rssi_dbm = -120.0;
  double phase_rad = 0.0;      // of the round trip in space, not wrapped, grows with distance
  double white_sigma_rad = 0;  // of the reader's phase measurement at this strength
  double weight = 1.0;         // relative chance to win a contended slot
};

// tag and antenna are indices into the scene's lists.
using RadioLink = std::function<LinkState(double t_s, std::size_t antenna, std::size_t tag, double frequency_hz)>;

// Link budget and fading by statistics: phase error as measured on real data.
[[nodiscard]] RadioLink make_statistical_link(const Scene& scene, std::uint64_t seed);

// Link from the environment's reflections (scene.environment).
[[nodiscard]] RadioLink make_physical_link(const Scene& scene);

// One-way power gain of an 8 dBi patch (half-power beam width 70 degrees) relative to boresight, in dB;
// cosine of the angle off boresight. Behind the antenna: its front-to-back ratio.
[[nodiscard]] double patch_gain_db(double cosine);

// Line of sight between antenna and tag.
struct Sight {
  double distance_m = 0.0;
  double cosine = 0.0;  // off the antenna's boresight
  Eigen::Vector3d p_S_A_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d boresight_S = Eigen::Vector3d::UnitX();
};
[[nodiscard]] Sight sight_of(const Scene& scene, double t_s, std::size_t antenna, std::size_t tag);

}  // namespace rfmvo::simulate
