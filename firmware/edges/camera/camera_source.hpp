// A camera as a source of events: a Start, then a Frame for every picture, at mid-exposure on the device's clock.
// It never ends by itself: a camera that is absent, stalls or goes away becomes a Fault, and is started anew.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>

#include "edges/camera/camera_device.hpp"
#include "edges/camera/frame_gaps.hpp"
#include "edges/camera/restart_policy.hpp"
#include "edges/device_clock.hpp"
#include "edges/event_io.hpp"

namespace rfmvo {

// Read by other threads while the camera runs.
struct CameraCounters {
  std::atomic<std::uint64_t> frames{0}, lost{0}, damaged{0}, restarts{0};
  std::atomic<bool> running{false};
};

class CameraSource : public EventSource {
 public:
  struct Parts {
    std::unique_ptr<CameraDevice> device;
    DeviceClockFunction clock;
    std::function<ClockOffsets()> offsets;
    std::function<void(Duration)> pause;  // between two looks at a camera that is not there
    std::shared_ptr<CameraCounters> counters;
  };
  // `config.camera`, the readout time and journal.frames count. Once `stop` is set, next() ends the stream within 50 ms.
  CameraSource(Parts parts, const Config& config, const std::atomic<bool>& stop);
  ~CameraSource() override;

  [[nodiscard]] Result<std::optional<Event>> next() override;
  // Exposure and gain from the next picture on; from any thread.
  void adjust(double exposure_s, double gain);

 private:
  void try_start(DeviceTime now);
  void fail(DeviceTime now, const std::string& why);
  void look(DeviceTime now);
  void on_picture(const CapturedImage& image, DeviceTime now);
  [[nodiscard]] Result<Frame> frame_of(const CapturedImage& image) const;
  [[nodiscard]] DeviceTime time_of_picture(const CapturedImage& image, DeviceTime arrival);
  void take_adjustment(DeviceTime now);

  Parts parts_;
  CameraConfig config_;
  JournalConfig journal_;
  ImageWindow window_;
  ShutterTiming shutter_;
  const std::atomic<bool>& stop_;

  bool started_ = false, running_ = false, stamps_doubted_ = false;
  std::string last_failure_;
  std::vector<std::string> last_notes_;
  RestartPolicy policy_;
  FrameGaps gaps_;
  ClockOffsets offsets_;
  DeviceTime offsets_read_;
  std::optional<DeviceTime> last_time_;
  std::uint64_t lost_told_ = 0;
  DeviceTime lost_told_at_;
  std::deque<Event> waiting_;

  std::mutex adjust_mutex_;
  std::optional<CameraConfig> adjustment_;
};

}  // namespace rfmvo
