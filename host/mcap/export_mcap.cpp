#include "mcap/export_mcap.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>

#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "evaluate/last_estimates.hpp"
#include "mcap/foxglove_messages.hpp"
#include "mcap/foxglove_schemas.hpp"
#include "mcap/mcap_writer.hpp"

namespace rfmvo::mcap {
namespace {

bool same(const TagEstimate& a, const TagEstimate& b) {
  return a.status == b.status && a.p_W_X_m == b.p_W_X_m && a.covariance_m2 == b.covariance_m2 &&
         a.hypotheses.size() == b.hypotheses.size();
}

class Exporter {
 public:
  explicit Exporter(McapWriter& writer) : writer_(writer) {
    const std::string scene = scene_update_schema();
    tf_ = writer.add_channel("/tf", "foxglove.FrameTransform", frame_transform_schema());
    tags_ = writer.add_channel("/tags", "foxglove.SceneUpdate", scene);
    path_ = writer.add_channel("/path", "foxglove.SceneUpdate", scene);
    image_ = writer.add_channel("/camera/image", "foxglove.CompressedImage", compressed_image_schema());
    camera_ = writer.add_channel("/camera/calibration", "foxglove.CameraCalibration", camera_calibration_schema());
    log_ = writer.add_channel("/log", "foxglove.Log", log_schema());
  }

  // Events.
  Status operator()(const Start& start) {
    return put(camera_, start.time, camera_calibration(start.calibration.camera, start.time));
  }
  Status operator()(const Frame& frame) {
    const Json image = compressed_image(frame);
    if (image.is_null()) return Done{};
    ++figures_.images;
    return put(image_, frame.time, image);
  }
  Status operator()(const Fault& fault) { return say(fault.time, LogLevel::kWarning, fault.source, fault.text); }
  Status operator()(const Command& command) {
    return say(command.time, LogLevel::kInfo, "command", command.key + " " + command.value);
  }
  template <class Other>
  Status operator()(const Other&) {
    return Done{};
  }
  // Estimates.
  Status operator()(const MetricPose& pose) { return put(tf_, pose.time, frame_transform(pose)); }
  Status operator()(const TagEstimate& tag) {
    const auto known = last_.find(tag.epc);
    if (known != last_.end() && same(known->second, tag)) return Done{};
    last_.insert_or_assign(tag.epc, tag);
    figures_.tags = last_.size();
    return put(tags_, tag.time, scene_update(tag));
  }
  Status operator()(const Trajectory& trajectory) { return put(path_, trajectory.time, scene_update(trajectory)); }
  Status operator()(const MapRevision& revision) {
    return say(revision.time, LogLevel::kInfo, "map",
               fmt::format("revision {}: {}", revision.revision, revision.reason));
  }
  Status operator()(const Health& health) {
    const bool changed = !health_ || health_->vo_status != health.vo_status;
    const bool fault = health.faults > (health_ ? health_->faults : 0);
    health_ = health;
    const LogLevel level = health.vo_status == VoStatus::kLost ? LogLevel::kError : LogLevel::kInfo;
    if (changed)
      if (Status s = say(health.time, level, "odometry", evaluate::label_of(health.vo_status)); !s) return s;
    return fault ? say(health.time, LogLevel::kWarning, "health", health.last_fault) : Status(Done{});
  }

  [[nodiscard]] McapFigures figures() const {
    McapFigures figures = figures_;
    figures.messages = writer_.messages();
    return figures;
  }

 private:
  Status say(DeviceTime time, LogLevel level, const std::string& name, const std::string& text) {
    return put(log_, time, log_message(time, level, name, text));
  }
  Status put(std::uint16_t channel, DeviceTime time, const Json& json) {
    return writer_.write(channel, time.ns, json.dump(-1, ' ', false, Json::error_handler_t::replace));
  }

  McapWriter& writer_;
  std::uint16_t tf_, tags_, path_, image_, camera_, log_;
  std::map<Epc, TagEstimate> last_;
  std::optional<Health> health_;
  McapFigures figures_;
};

Status add_log(const std::string& path, const std::string& prefix, Exporter& exporter,
               const std::function<void(std::int64_t)>& watch) {
  auto file = LogFileReader::open(path);
  if (!file) return file.error();
  while (true) {
    auto read = file.value()->next();
    if (!read) return read.error();
    if (!read.value()) return Done{};
    const LogRecord& record = *read.value();
    if (watch) watch(record.offset);
    const auto in_record = [&](const Error& error) {
      return Error{error.code, error.text(), file.value()->where(record.offset)};
    };
    if (is_event_channel(record.channel, prefix)) {
      const auto event = decode_event(record.channel, record.data, prefix);
      if (!event) return in_record(event.error());
      if (Status s = std::visit(exporter, event.value()); !s) return s;
    } else if (is_estimate_channel(record.channel, prefix)) {
      const auto estimate = decode_estimate(record.channel, record.data, prefix);
      if (!estimate) return in_record(estimate.error());
      if (Status s = std::visit(exporter, estimate.value()); !s) return s;
    }
  }
}

}  // namespace

Result<McapFigures> export_mcap(const std::vector<std::string>& logs, const std::string& prefix,
                                const std::string& path, const std::function<void(std::int64_t)>& watch) {
  auto writer = McapWriter::create(path);
  if (!writer) return writer.error();
  Exporter exporter(*writer.value());
  for (const std::string& log : logs)
    if (const Status s = add_log(log, prefix, exporter, watch); !s) return s.error();
  const McapFigures figures = exporter.figures();
  if (figures.messages == 0)
    return Error{ErrorCode::kNotFound, "holds nothing that can be shown (prefix " + prefix + ")", logs.front()};
  if (const Status s = writer.value()->close(); !s) return s.error();
  return figures;
}

}  // namespace rfmvo::mcap
