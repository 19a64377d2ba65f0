#include "simulate/environment.hpp"
#include "simulate/renderer.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {

void attach_rendered_frames(Scene& scene, std::uint64_t seed) {
  scene.frame = [environment = scene.environment, camera = scene.calibration.camera, T_S_C = scene.T_S_C,
                 times_s = scene.frame_times_s, effects = scene.camera_effects, seed](std::size_t k) -> Result<Frame> {
    std::vector<std::uint8_t> grey = render_moving(*environment, camera, T_S_C, times_s[k], effects);
    Random random(seed, "camera noise", k);
    add_optics(grey, camera, effects, times_s[k], random);
    Frame frame;
    frame.width_px = camera.width_px;
    frame.height_px = camera.height_px;
    frame.encoding = "jpeg";
    frame.encoded = encode_jpeg(grey, camera);
    return frame;
  };
}

}  // namespace rfmvo::simulate
