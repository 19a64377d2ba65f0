#include "edges/camera/open_camera.hpp"

#include "edges/camera/v4l2_camera.hpp"
#ifdef RFMVO_WITH_LIBCAMERA
#include "edges/camera/libcamera_camera.hpp"
#endif

namespace rfmvo {
namespace {

constexpr std::string_view kV4l2 = "v4l2:", kLibcamera = "libcamera:";

}  // namespace

bool is_camera(std::string_view source) { return source.starts_with(kV4l2) || source.starts_with(kLibcamera); }

Result<std::unique_ptr<CameraDevice>> make_camera(const CameraConfig& config) {
  const std::string_view source = config.source;
  RFMVO_ASSERT(is_camera(source));
  if (source.starts_with(kV4l2)) {
    const std::string device(source.substr(kV4l2.size()));
    if (device.empty())
      return Error{ErrorCode::kMalformed, "names no device; v4l2:/dev/video0 is usually the first", "camera.source"};
    return std::unique_ptr<CameraDevice>(std::make_unique<V4l2Camera>(device, open_v4l2_node));
  }
#ifdef RFMVO_WITH_LIBCAMERA
  return std::unique_ptr<CameraDevice>(std::make_unique<LibcameraCamera>(std::string(source.substr(kLibcamera.size()))));
#else
  return Error{ErrorCode::kUnsupported, "this program was built without libcamera (libcamera-dev)", "camera.source"};
#endif
}

}  // namespace rfmvo
