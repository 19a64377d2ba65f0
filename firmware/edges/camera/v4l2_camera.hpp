// A camera behind Linux's V4L2: frames in memory shared with the driver (mmap streaming), single-planar formats.
#pragma once

#include "edges/camera/camera_device.hpp"
#include "edges/camera/v4l2_node.hpp"

namespace rfmvo {

class V4l2Camera : public CameraDevice {
 public:
  V4l2Camera(std::string device, OpenV4l2Node open);
  ~V4l2Camera() override;

  [[nodiscard]] Result<CameraMode> start(const CameraConfig& config) override;
  [[nodiscard]] Result<std::optional<CapturedImage>> next(Duration wait) override;
  [[nodiscard]] std::vector<std::string> adjust(const CameraConfig& config) override;
  void stop() override;

 private:
  struct Buffer {
    const std::uint8_t* start = nullptr;
    std::size_t bytes = 0;
  };

  [[nodiscard]] Status choose_format(const CameraConfig& config);
  [[nodiscard]] Status set_format(const CameraConfig& config, std::uint32_t fourcc);
  void set_rate(const CameraConfig& config, CameraMode& mode);
  [[nodiscard]] Status start_streaming();
  [[nodiscard]] Status queue(std::uint32_t index);
  [[nodiscard]] bool set_control(std::uint32_t id, std::int64_t value);
  [[nodiscard]] std::optional<std::int64_t> get_control(std::uint32_t id);
  void read_exposure();
  [[nodiscard]] Error trouble(const std::string& what, int error) const;

  std::string device_;
  OpenV4l2Node open_;
  std::unique_ptr<V4l2Node> node_;
  PixelFormat format_ = PixelFormat::kGrey;
  int width_px_ = 0, height_px_ = 0;
  std::size_t stride_bytes_ = 0;
  std::vector<Buffer> buffers_;
  std::optional<std::uint32_t> lent_;  // the buffer behind the last picture
  bool streaming_ = false;
  bool uvc_ = false;
  bool automatic_exposure_ = false;
  int pictures_ = 0;
  std::optional<Duration> exposure_;  // as the driver has it
};

}  // namespace rfmvo
