// The estimator's only input: one ordered stream of events. Live, replay and simulation feed the
// same stream; each event is journalled BEFORE the pipeline sees it, and time comes from events only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/time.hpp"
#include "config/calibration.hpp"
#include "config/config.hpp"
#include "geometry/rigid.hpp"
#include "rf/tag_read.hpp"

namespace rfmvo {

struct Start {
  DeviceTime time;
  Config config;
  Calibration calibration;
};

struct Frame {
  DeviceTime time;  // mid exposure
  std::int64_t sequence = 0;
  int width_px = 0;
  int height_px = 0;
  std::shared_ptr<const std::vector<std::uint8_t>> grey;  // width * height bytes, row by row; null = not decoded
  // The image as it was recorded, if it came compressed ("jpeg", "png"): journalled as it is.
  std::string encoding = "grey8";
  std::shared_ptr<const std::vector<std::uint8_t>> encoded;
};

enum class VoStatus : std::int8_t { kInitialising = 0, kTracking = 1, kDegraded = 2, kLost = 3 };

struct CameraPose {
  DeviceTime time;
  std::uint32_t segment = 0;  // changes whenever continuity of the scale cannot be vouched for
  VoStatus status = VoStatus::kInitialising;
  int inliers = 0;
  UnscaledPose T_V_C;  // meaningful only if kTracking or kDegraded
  // Covariance of the motion since the previous pose: rotation vector (rad), then translation
  // (units of V), both in C.
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

struct Tick {
  DeviceTime time;
};

struct Fault {
  DeviceTime time;
  std::string source;  // "camera", "reader", "journal", ...
  std::string text;
};

// How the link to the reader is: at every change, and each second.
struct ReaderStatus {
  DeviceTime time;
  bool reading = false;         // set up, reports may come
  bool clock_known = false;     // the reader's clock has been seen
  double clock_offset_s = 0.0;  // device clock less reader clock at `time`; years, if the reader has no clock
  double clock_drift = 0.0;     // of the offset, s/s
  double clock_sigma_s = 0.0;   // 1 sigma of the offset, but for the shortest delay of the network
  std::uint32_t clock_steps = 0;
  std::uint32_t connections = 0;
  std::uint64_t reports_lost = 0;  // of tags, that made no read: no phase, no channel, ...
};

struct Command {
  DeviceTime time;
  std::string key;
  std::string value;
};

using Event = std::variant<Start, Frame, CameraPose, TagRead, Tick, Fault, ReaderStatus, Command>;

[[nodiscard]] inline DeviceTime time_of(const Event& event) {
  return std::visit([](const auto& e) { return e.time; }, event);
}

}  // namespace rfmvo
