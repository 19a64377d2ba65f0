#include "estimator/pipeline.hpp"

#include <algorithm>
#include <optional>
#include <variant>

#include "config/config_table.hpp"
#include "estimator/joint_estimator.hpp"
#include "estimator/paper_estimator.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo {

struct Pipeline::State {
  Worker* worker = nullptr;
  Config config;
  Calibration calibration;
  std::optional<VisualOdometry> odometry;
  std::optional<SamplingSynchronization> synchronization;
  std::variant<std::monostate, PaperEstimator, JointEstimator> estimator;
  std::vector<Estimate> out;
  DeviceTime now, last_publish;
  Health health;
  bool running = false;

  void on(const Start& start);
  void on(const Frame& frame);
  void on(const CameraPose& pose);
  void on(const TagRead& read);
  void on(const Tick&) {}
  void on(const Fault& fault);
  void on(const ReaderStatus& status) { health.reader = status; }
  void on(const Command& command);
  void track(const CameraPose& pose);
  void feed(const std::vector<SampledRead>& reads);
  void publish(bool final);
};

void Pipeline::State::on(const Start& start) {
  config = start.config;
  calibration = start.calibration;
  odometry.emplace(config.vision, calibration.camera);
  synchronization.emplace(config);
  if (config.estimator.kind == "paper")
    estimator.emplace<PaperEstimator>(config, calibration);
  else
    estimator.emplace<JointEstimator>(config, calibration, Window{}, worker);
  health = Health{};
  last_publish = start.time;
  running = true;
}

void Pipeline::State::on(const Frame& frame) {
  ++health.frames;
  if (config.estimator.pose_source == "frames" && frame.grey) track(odometry->on(frame));
}

void Pipeline::State::on(const CameraPose& pose) {
  if (config.estimator.pose_source == "poses") track(pose);
}

// A new camera pose: first the path, then the reads that it completes.
void Pipeline::State::track(const CameraPose& pose) {
  ++health.poses;
  health.vo_status = pose.status;
  health.segment = pose.segment;
  health.inliers = pose.inliers;
  out.emplace_back(pose);
  std::visit(
      [&](auto& e) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(e)>, std::monostate>) e.on(pose);
      },
      estimator);
  feed(synchronization->on(pose));
  if (const auto* joint = std::get_if<JointEstimator>(&estimator))
    if (const std::optional<MetricPose> metric = joint->newest_pose(); metric && metric->time == pose.time)
      out.emplace_back(*metric);
}

void Pipeline::State::on(const TagRead& read) {
  ++health.reads;
  feed(synchronization->on(read));
}

void Pipeline::State::feed(const std::vector<SampledRead>& reads) {
  for (const SampledRead& read : reads)
    std::visit(
        [&](auto& e) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(e)>, std::monostate>) e.on(read);
        },
        estimator);
}

void Pipeline::State::on(const Fault& fault) {
  ++health.faults;
  health.last_fault = fault.source + ": " + fault.text;
}

// What may change while running; everything else needs a new Start. The source has checked key and value.
void Pipeline::State::on(const Command& command) {
  const ConfigRow* row = find_row(command.key);
  if (row != nullptr && row->live) (void)set_value_from_text(config, command.key, command.value);
}

void Pipeline::State::publish(bool final) {
  std::visit(
      [&](auto& e) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(e)>, std::monostate>) e.publish(now, final, out);
      },
      estimator);
  health.time = now;
  health.reads_without_pose = synchronization->reads_without_pose();
  if (const auto* joint = std::get_if<JointEstimator>(&estimator)) health.reads_rejected = joint->reads_rejected();
  health.tags = health.tags_located = 0;
  for (const Estimate& e : out)
    if (const auto* tag = std::get_if<TagEstimate>(&e)) {
      ++health.tags;
      if (tag->status == TagStatus::kConverged) ++health.tags_located;
    }
  out.emplace_back(health);
  last_publish = now;
}

Pipeline::Pipeline(Worker* worker) : state_(std::make_unique<State>()) { state_->worker = worker; }
Pipeline::~Pipeline() = default;

std::span<const Estimate> Pipeline::on(const Event& event) {
  State& s = *state_;
  s.out.clear();
  if (!s.running && !std::holds_alternative<Start>(event)) return s.out;
  s.now = std::max(s.now, time_of(event));
  std::visit([&](const auto& e) { s.on(e); }, event);
  if ((s.now - s.last_publish).seconds() >= s.config.estimator.publish_interval_s) s.publish(false);
  return s.out;
}

std::span<const Estimate> Pipeline::finish() {
  State& s = *state_;
  s.out.clear();
  if (s.running) s.publish(true);
  return s.out;
}

}  // namespace rfmvo
