// Places that carts drive through: racks with cartons on both sides of an aisle, a cross-aisle, a corridor; and
// people and fork-lifts that cross. All in S: x along the aisle, y to its left, z up.
#pragma once

#include <vector>

#include "simulate/environment.hpp"
#include "simulate/random.hpp"

namespace rfmvo::simulate {

inline constexpr double kLeftRack_m = 1.6;    // front of the racks on the left
inline constexpr double kRackBegin_m = -4.0;  // of the left racks
inline constexpr double kCrossAisleBegin_m = 12.0, kCrossAisleEnd_m = 15.0;
inline constexpr double kCorridorHalfWidth_m = 1.3;
inline constexpr double kCorridorEnd_m = 24.0;

// Returns where labels would be stuck on cartons of the left racks, seen from the aisle: along x, between 0.4 and 1.7 m
// up.
std::vector<Eigen::Vector3d> build_warehouse(Environment& environment, std::uint64_t seed);

// From x = -3 m to kCorridorEnd_m; a place on the left wall every 1.2 m.
std::vector<Eigen::Vector3d> build_corridor(Environment& environment, std::uint64_t seed);

// Someone who walks along x at this height above the floor, from `from` at from_s on, with this velocity (m/s).
struct Crossing {
  Eigen::Vector3d from;
  double from_s = 0.0;
  double speed_m_s = 1.0;  // along x; negative: towards -x
};
[[nodiscard]] Mover make_person(const Crossing& crossing, Random& look);
[[nodiscard]] Mover make_forklift(const Crossing& crossing, Random& look);

}  // namespace rfmvo::simulate
