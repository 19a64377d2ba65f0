// The racks, cartons, floor and ceiling of a warehouse aisle, for the eye and for the radio waves.
#pragma once

#include <cstdint>
#include <vector>

#include "simulate/environment.hpp"

namespace rfmvo::simulate {

struct Carton {
  Eigen::Vector3d low, high;  // its front is the face y = low.y()
};

// Fills `environment`; returns the cartons of the rack to the left, sorted by x.
[[nodiscard]] std::vector<Carton> build_aisle(Environment& environment, std::uint64_t seed);

}  // namespace rfmvo::simulate
