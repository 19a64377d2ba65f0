// What the page shows, from whatever is heard: the picture, tags in it, the map, the health. Each as one message to the
// page: JSON, or the picture's own bytes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "estimator/event.hpp"
#include "status/box_status.hpp"

namespace rfmvo::view {

class ViewModel {
 public:
  explicit ViewModel(const std::string& prefix) : prefix_(prefix), status_(prefix) {}

  void on(const BusMessage& message, std::int64_t now_ns);

  // Counts up whenever what the message shows has changed.
  [[nodiscard]] std::uint64_t picture_version() const { return picture_version_; }
  [[nodiscard]] std::uint64_t overlay_version() const { return overlay_version_; }
  [[nodiscard]] std::uint64_t map_version() const { return map_version_; }

  [[nodiscard]] std::string picture() const;  // JPEG or PNG; empty: there is none yet
  [[nodiscard]] std::string overlay() const;  // {"type":"overlay", size of the picture, tags in it, the camera's place}
  [[nodiscard]] std::string map() const;      // {"type":"map", paths, tags with their ellipsoids}
  [[nodiscard]] std::string status(const status::View& view) const;  // {"type":"status", ...as `rfmvo status --json`}

 private:
  void on_event(const Event& event);
  void on_estimate(const Estimate& estimate);
  // Of the newest path where it reaches the picture's time, because tags are of the newest scale too; else as it was
  // said.
  [[nodiscard]] std::optional<Rigid3> camera_pose() const;

  std::string prefix_;
  status::BoxStatus status_;
  std::optional<Start> start_;
  std::optional<Frame> frame_;
  std::map<std::uint32_t, Trajectory> paths_;
  std::uint64_t picture_version_ = 0, overlay_version_ = 0, map_version_ = 0;
};

}  // namespace rfmvo::view
