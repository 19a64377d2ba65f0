#include "edges/camera/captured_image.hpp"

#include <algorithm>
#include <cstring>

namespace rfmvo {
namespace {

using Grey = std::vector<std::uint8_t>;

// Bytes from one grey level to the next.
std::size_t step_of(PixelFormat format) { return format == PixelFormat::kYuyv ? 2 : 1; }

void copy_row(const std::uint8_t* from, std::size_t step, std::uint8_t* to, std::size_t width, bool flip) {
  if (step == 1) {
    std::memcpy(to, from, width);
  } else {
    for (std::size_t x = 0; x < width; ++x) to[x] = from[x * step];
  }
  if (flip) std::reverse(to, to + width);
}

// Everything has been checked.
std::shared_ptr<const Grey> copy_window(const std::uint8_t* bytes, std::size_t stride, std::size_t step,
                                        const ImageWindow& window) {
  const auto width = static_cast<std::size_t>(window.width_px), height = static_cast<std::size_t>(window.height_px);
  const std::uint8_t* first =
      bytes + static_cast<std::size_t>(window.y_px) * stride + static_cast<std::size_t>(window.x_px) * step;
  auto grey = std::make_shared<Grey>(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t to = window.flip_vertical ? height - 1 - y : y;
    copy_row(first + y * stride, step, grey->data() + to * width, width, window.flip_horizontal);
  }
  return grey;
}

bool is_inside(const ImageWindow& window, int width_px, int height_px) {
  return window.x_px >= 0 && window.y_px >= 0 && window.width_px > 0 && window.height_px > 0 &&
         window.x_px <= width_px - window.width_px && window.y_px <= height_px - window.height_px;
}

}  // namespace

std::string_view name_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kGrey: return "grey";
    case PixelFormat::kNv12: return "nv12";
    case PixelFormat::kYuv420: return "yuv420";
    case PixelFormat::kYuyv: return "yuyv";
    case PixelFormat::kMjpeg: return "mjpg";
  }
  return "?";
}

bool ImageWindow::is_whole(const CapturedImage& image) const {
  return x_px == 0 && y_px == 0 && width_px == image.width_px && height_px == image.height_px && !flip_horizontal &&
         !flip_vertical;
}

ImageWindow window_of(const CameraConfig& config) {
  const auto or_rest = [](std::int64_t size, std::int64_t start, std::int64_t all) {
    return static_cast<int>(size > 0 ? size : all - start);
  };
  return {static_cast<int>(config.crop_x_px),
          static_cast<int>(config.crop_y_px),
          or_rest(config.crop_width_px, config.crop_x_px, config.width_px),
          or_rest(config.crop_height_px, config.crop_y_px, config.height_px),
          config.flip == "horizontal" || config.flip == "both",
          config.flip == "vertical" || config.flip == "both"};
}

Result<std::shared_ptr<const std::vector<std::uint8_t>>> grey_of(const CapturedImage& image, const ImageWindow& window) {
  RFMVO_ASSERT(image.format != PixelFormat::kMjpeg);
  if (!is_inside(window, image.width_px, image.height_px))
    return Error{ErrorCode::kMalformed, "the crop is not inside the picture", "camera"};
  const std::size_t step = step_of(image.format);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width_px) * step;
  const std::size_t needed = image.stride_bytes * static_cast<std::size_t>(image.height_px - 1) + row_bytes;
  if (image.stride_bytes < row_bytes || image.bytes.size() < needed)
    return Error{ErrorCode::kMalformed,
                 "a picture of " + std::to_string(image.bytes.size()) + " bytes, expected are " + std::to_string(needed),
                 "camera"};
  return copy_window(image.bytes.data(), image.stride_bytes, step, window);
}

std::shared_ptr<const std::vector<std::uint8_t>> cut(std::span<const std::uint8_t> grey, int width_px, int height_px,
                                                     const ImageWindow& window) {
  RFMVO_ASSERT(is_inside(window, width_px, height_px));
  RFMVO_ASSERT(grey.size() == static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  return copy_window(grey.data(), static_cast<std::size_t>(width_px), 1, window);
}

}  // namespace rfmvo
