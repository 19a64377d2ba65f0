// Camera images of an environment: perspective, depth buffer, exposure time, rolling shutter, lens and sensor.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"
#include "simulate/environment.hpp"

namespace rfmvo::simulate {

// How the camera takes a picture. The stamp is the middle of the exposure of the middle row.
struct CameraEffects {
  double exposure_s = 0.0;             // motion blur
  double readout_s = 0.0;              // rolling shutter: from the first row to the last; 0: global
  double lens_blur_px = 0.7;           // 1 sigma; also softens the rasteriser's stairs
  double noise_grey = 1.5;             // 1 sigma, of 8 bits
  double vignetting = 0.0;             // share of the light that the corners lack
  std::function<double(double)> gain;  // of the exposure control at a time (s); empty: 1
};

// width * height bytes. The camera must be free of distortion.
[[nodiscard]] std::vector<std::uint8_t> render(const Environment& environment, const CameraModel& camera,
                                               const Rigid3& T_S_C);

// The picture stamped t_s of a moving camera; what moves in the environment is where it is then.
[[nodiscard]] std::vector<std::uint8_t> render_moving(const Environment& environment, const CameraModel& camera,
                                                      const std::function<Rigid3(double)>& T_S_C, double t_s,
                                                      const CameraEffects& effects);

// Share of the picture that movers cover.
[[nodiscard]] double occluded_share(const Environment& environment, const CameraModel& camera, const Rigid3& T_S_C,
                                    double t_s);

// Defocus of a cheap lens, vignetting and the noise of a small sensor; `random` is this frame's own.
void add_optics(std::vector<std::uint8_t>& grey, const CameraModel& camera, const CameraEffects& effects, double t_s,
                Random& random);

[[nodiscard]] std::shared_ptr<const std::vector<std::uint8_t>> encode_jpeg(const std::vector<std::uint8_t>& grey,
                                                                           const CameraModel& camera);

}  // namespace rfmvo::simulate
