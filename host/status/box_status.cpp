#include "status/box_status.hpp"

#include <fmt/format.h>

#include "edges/lcm_codec.hpp"
#include "evaluate/last_estimates.hpp"

namespace rfmvo::status {
namespace {

constexpr double kSilence_s = 5.0;  // HEALTH comes once a second unless configured otherwise (up to 60 s)

template <class Count>
double rate(Count before, Count after, double s) {
  return after > before && s > 0.0 ? static_cast<double>(after - before) / s : 0.0;
}

}  // namespace

void BoxStatus::on(const BusMessage& message, std::int64_t now_ns) {
  if (!is_estimate_channel(message.channel, prefix_)) return;
  const auto estimate = decode_estimate(message.channel, message.data, prefix_);
  if (!estimate) {
    // POSE is a copy that is not read back.
    if (message.channel != prefix_ + "POSE") ++broken_;
    return;
  }
  ++messages_;
  on(estimate.value(), now_ns);
}

void BoxStatus::on(const Estimate& estimate, std::int64_t now_ns) {
  if (const auto* tag = std::get_if<TagEstimate>(&estimate)) tags_.insert_or_assign(tag->epc, *tag);
  if (const auto* pose = std::get_if<MetricPose>(&estimate)) pose_ = *pose;
  if (const auto* health = std::get_if<Health>(&estimate)) on_health(*health, now_ns);
  if (const auto* scale = std::get_if<ScaleEstimate>(&estimate))
    if (!scale_ || scale->segment >= scale_->segment || scale->time < scale_->time) scale_ = *scale;
}

void BoxStatus::on_health(const Health& health, std::int64_t now_ns) {
  if (health_ && health.time > health_->time) {
    const double s = (health.time - health_->time).seconds();
    rates_ = Rates{rate(health_->frames, health.frames, s), rate(health_->poses, health.poses, s),
                   rate(health_->reads, health.reads, s)};
  }
  if (health_ && health.time < health_->time) {  // another run: what was known of the last one is over
    tags_.clear();
    scale_.reset();
    pose_.reset();
    rates_.reset();
  }
  health_ = health;
  health_ns_ = now_ns;
}

std::optional<double> BoxStatus::silence_s(std::int64_t now_ns) const {
  if (!health_) return std::nullopt;
  return static_cast<double>(now_ns - health_ns_) * 1e-9;
}

std::vector<std::string> BoxStatus::problems(std::int64_t now_ns) const {
  if (!health_) return {"nothing heard of a box"};
  std::vector<std::string> problems;
  if (*silence_s(now_ns) > kSilence_s)
    problems.push_back(fmt::format("nothing heard for {:.0f} s", *silence_s(now_ns)));
  if (health_->vo_status == VoStatus::kLost) problems.push_back("odometry LOST");
  const bool has_reader = health_->reader.time.ns != 0;
  if (has_reader && !health_->reader.reading) problems.push_back("reader is not reading");
  if (has_reader && health_->reader.reading && !health_->reader.clock_known)
    problems.push_back("the reader's clock is not known yet");
  return problems;
}

}  // namespace rfmvo::status
