// What a box has said lately: its health, tags and scale, and how often it says so.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus_listener.hpp"
#include "estimator/estimate.hpp"

namespace rfmvo::status {

struct Rates {
  double frames_hz = 0.0, poses_hz = 0.0, reads_hz = 0.0;
};

class BoxStatus {
 public:
  explicit BoxStatus(std::string prefix) : prefix_(std::move(prefix)) {}

  // `now_ns`: of a clock without steps. What is not of the box, or broken, is counted and passed over.
  void on(const BusMessage& message, std::int64_t now_ns);

  [[nodiscard]] const std::optional<Health>& health() const { return health_; }
  [[nodiscard]] const std::map<Epc, TagEstimate>& tags() const { return tags_; }
  [[nodiscard]] const std::optional<ScaleEstimate>& scale() const { return scale_; }  // of the newest segment
  [[nodiscard]] const std::optional<MetricPose>& pose() const { return pose_; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t broken() const { return broken_; }
  // From the counters of the last two health reports.
  [[nodiscard]] const std::optional<Rates>& rates() const { return rates_; }
  // Since the last health report; nothing before the first.
  [[nodiscard]] std::optional<double> silence_s(std::int64_t now_ns) const;
  // What is wrong with it, in words; empty: it is well.
  [[nodiscard]] std::vector<std::string> problems(std::int64_t now_ns) const;

 private:
  void on(const Estimate& estimate, std::int64_t now_ns);
  void on_health(const Health& health, std::int64_t now_ns);

  std::string prefix_;
  std::optional<Health> health_;
  std::int64_t health_ns_ = 0;
  std::map<Epc, TagEstimate> tags_;
  std::optional<ScaleEstimate> scale_;
  std::optional<MetricPose> pose_;
  std::optional<Rates> rates_;
  std::uint64_t messages_ = 0, broken_ = 0;
};

struct View {
  std::int64_t now_ns = 0;
  BusLoss loss;
  bool colours = false;
  std::size_t tag_rows = 40;
};

[[nodiscard]] std::string to_screen(const BoxStatus& status, const View& view);  // lines, many
[[nodiscard]] std::string to_line(const BoxStatus& status, const View& view);    // one, with its newline
[[nodiscard]] std::string to_json(const BoxStatus& status, const View& view);    // one object, without a newline

}  // namespace rfmvo::status
