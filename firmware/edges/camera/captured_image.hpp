// One picture as a driver hands it over, still in the driver's memory; and its grey levels.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "config/config.hpp"
#include "edges/camera/sensor_time.hpp"

namespace rfmvo {

enum class PixelFormat {
  kGrey,    // one byte per pixel
  kNv12,    // a plane of grey levels first, then colour, which is not looked at
  kYuv420,  // the same, other colour
  kYuyv,    // every second byte is a grey level, the first one too
  kMjpeg,   // a JPEG file
};

// Names as in the configuration (camera.format).
[[nodiscard]] std::string_view name_of(PixelFormat format);

struct CapturedImage {
  PixelFormat format = PixelFormat::kGrey;
  int width_px = 0, height_px = 0;
  std::size_t stride_bytes = 0;  // from one row of grey levels to the next; drivers pad rows. Not of kMjpeg
  std::span<const std::uint8_t> bytes;
  SensorStamp stamp;
  std::uint32_t sequence = 0;        // the driver's counter: a gap is a picture that was lost
  std::optional<Duration> exposure;  // of this picture, if the camera says
  bool damaged = false;              // the driver says so: not to be used, but it has been counted
};

// The part of a picture that is used, and how it is turned.
struct ImageWindow {
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
  bool flip_horizontal = false, flip_vertical = false;  // after the cut

  [[nodiscard]] bool is_whole(const CapturedImage& image) const;  // nothing to cut, nothing to flip
};
[[nodiscard]] ImageWindow window_of(const CameraConfig& config);

// Grey levels of the window, row by row. The one copy out of the driver's few buffers, which must go back at once; rows
// of a grey plane are copied as they are, without a conversion. Errors: kMalformed, the picture is shorter than its
// size says, or the window is not inside it. Not for kMjpeg.
[[nodiscard]] Result<std::shared_ptr<const std::vector<std::uint8_t>>> grey_of(const CapturedImage& image,
                                                                               const ImageWindow& window);
// The same cut out of grey levels without padding.
[[nodiscard]] std::shared_ptr<const std::vector<std::uint8_t>> cut(std::span<const std::uint8_t> grey, int width_px,
                                                                   int height_px, const ImageWindow& window);

}  // namespace rfmvo
