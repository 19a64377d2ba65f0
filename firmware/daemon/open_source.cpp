#include "daemon/open_source.hpp"

#include <ctime>

#include "edges/camera/clock_offsets.hpp"
#include "edges/camera/open_camera.hpp"
#include "edges/image_folder.hpp"
#include "edges/journal.hpp"
#include "edges/live_images.hpp"
#include "edges/open_reader.hpp"

namespace rfmvo {
namespace {

Result<OpenedSource> open_journal(const std::string& path, const Config& config) {
  const auto summary = summarise_journal(path, config.lcm.prefix);
  if (!summary) return summary.error();
  if (const Status s = check_pose_source(summary.value(), config, path); !s) return s.error();
  auto reader = JournalReader::open(path, config.lcm.prefix, {config.estimator.pose_source == "frames"});
  if (!reader) return reader.error();
  OpenedSource opened;
  opened.events = std::move(reader).value();
  opened.start = summary.value().start.time;
  opened.clock = device_clock();
  return opened;
}

Result<OpenedSource> open_live(const LiveSource::MakeCamera& make_camera, OpenedSource opened, const Config& config,
                               const std::optional<Calibration>& calibration, LiveSource::Options options) {
  std::unique_ptr<Reader> reader;
  if (!config.reader.address.empty()) {
    auto answer = open_reader(config, calibration, opened.clock);
    if (!answer) return answer.error();
    reader = std::move(answer).value();
  }
  auto live = std::make_unique<LiveSource>(make_camera, std::move(reader), opened.clock, std::move(options));
  opened.live = live.get();
  opened.events = std::move(live);
  return opened;
}

Error needs_frames(const std::string& what) {
  return {ErrorCode::kUnsupported, what + " no camera poses; \"frames\" is needed", "estimator.pose_source"};
}

// Images as if taken now, and the reader, if there is one.
Result<OpenedSource> open_images(const std::string& directory, const Config& config,
                                 const std::optional<Calibration>& calibration, std::function<bool()> should_stop) {
  auto folder = ImageFolder::open(directory);
  if (!folder) return folder.error();
  if (config.estimator.pose_source != "frames") return needs_frames("images have");
  const CameraModel& own = folder.value()->camera();
  if (calibration && (calibration->camera.width_px != own.width_px || calibration->camera.height_px != own.height_px))
    return Error{ErrorCode::kMalformed,
                 "the camera's width_px and height_px are not those of " + directory + "/calib.txt",
                 config.daemon.calibration};
  OpenedSource opened;
  opened.clock = device_clock();
  if (config.camera.start_time_s == 0.0 && config.reader.address.empty()) {
    opened.events = std::move(folder).value();
    return opened;
  }
  const double start_s = config.camera.start_time_s;
  opened.start = start_s > 0.0 ? DeviceTime{Duration::from_seconds(start_s).ns} : opened.clock();
  opened.camera_counters->running = true;
  const auto make_camera = [&folder, first = opened.start, clock = opened.clock](const std::atomic<bool>& stop) {
    return std::make_unique<LiveImages>(std::move(folder).value(), first, clock, stop);
  };
  // Files can wait for the estimator.
  return open_live(make_camera, std::move(opened), config, calibration, {WhenFull::kWait, std::move(should_stop)});
}

void pause_for(Duration pause) {
  const timespec time{pause.ns / 1'000'000'000, pause.ns % 1'000'000'000};
  (void)::nanosleep(&time, nullptr);
}

Result<OpenedSource> open_camera(const Config& config, const std::optional<Calibration>& calibration,
                                 std::function<bool()> should_stop) {
  if (config.estimator.pose_source != "frames") return needs_frames("a camera has");
  if (!calibration)
    return Error{ErrorCode::kMalformed, "is not set; a camera needs its calibration", "daemon.calibration"};
  const ImageWindow window = window_of(config.camera);
  const CameraModel& model = calibration->camera;
  if (model.width_px != window.width_px || model.height_px != window.height_px)
    return Error{ErrorCode::kMalformed,
                 "the camera's width_px and height_px are not those of the configured picture, " +
                     std::to_string(window.width_px) + " x " + std::to_string(window.height_px),
                 config.daemon.calibration};
  auto device = make_camera(config.camera);
  if (!device) return device.error();
  OpenedSource opened;
  opened.clock = device_clock();
  opened.start = opened.clock();
  CameraSource* made = nullptr;
  const auto make = [&made, &device, &config, clock = opened.clock,
                     counters = opened.camera_counters](const std::atomic<bool>& stop) {
    auto camera = std::make_unique<CameraSource>(
        CameraSource::Parts{std::move(device).value(), clock, [clock] { return read_clock_offsets(clock); }, pause_for,
                            counters},
        config, stop);
    made = camera.get();
    return camera;
  };
  auto live =
      open_live(make, std::move(opened), config, calibration, {WhenFull::kDropOldestFrame, std::move(should_stop)});
  if (!live) return live.error();
  OpenedSource result = std::move(live).value();
  result.camera = made;
  return result;
}

}  // namespace

Result<OpenedSource> open_source(const Config& config, const std::optional<Calibration>& calibration,
                                 std::function<bool()> should_stop) {
  const std::string& source = config.camera.source;
  constexpr std::string_view kJournal = "journal:", kImages = "images:";
  if (source.starts_with(kJournal) && !config.reader.address.empty())
    return Error{ErrorCode::kUnsupported, "a journal has its own reads; reader.address must be empty", "camera.source"};
  if (source.starts_with(kJournal)) return open_journal(source.substr(kJournal.size()), config);
  if (source.starts_with(kImages))
    return open_images(source.substr(kImages.size()), config, calibration, std::move(should_stop));
  if (is_camera(source)) return open_camera(config, calibration, std::move(should_stop));
  const std::string known = "known are v4l2:DEVICE, libcamera:ID, images:DIR and journal:FILE";
  if (source.empty()) return Error{ErrorCode::kMalformed, "is not set; " + known, "camera.source"};
  return Error{ErrorCode::kUnsupported, "\"" + source + "\" is not supported; " + known, "camera.source"};
}

}  // namespace rfmvo
