// Camera images of an environment: perspective, depth buffer, mild blur and sensor noise.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"
#include "simulate/environment.hpp"

namespace rfmvo::simulate {

// width * height bytes. The camera must be free of distortion.
[[nodiscard]] std::vector<std::uint8_t> render(const Environment& environment, const CameraModel& camera,
                                               const Rigid3& T_S_C);

// Defocus of a cheap lens and the noise of a small sensor; `random` is this frame's own.
void add_optics(std::vector<std::uint8_t>& grey, const CameraModel& camera, Random& random);

[[nodiscard]] std::shared_ptr<const std::vector<std::uint8_t>> encode_jpeg(const std::vector<std::uint8_t>& grey,
                                                                           const CameraModel& camera);

}  // namespace rfmvo::simulate
