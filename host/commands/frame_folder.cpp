#include "commands/frame_folder.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "commands/whole_file.hpp"
#include "edges/toml_files.hpp"

namespace rfmvo {

Result<FrameFolder> FrameFolder::create(const std::string& directory) {
  std::error_code failure;
  const std::filesystem::path path = std::filesystem::absolute(directory);
  std::filesystem::create_directories(path / "images", failure);
  if (failure) return Error{ErrorCode::kUnwritable, failure.message(), directory};
  std::filesystem::remove(path / "times.txt", failure);
  return FrameFolder(path.string());
}

Status FrameFolder::write(const Event& event) {
  if (const auto* start = std::get_if<Start>(&event)) return write(*start);
  if (const auto* frame = std::get_if<Frame>(&event)) return write(*frame);
  return Done{};
}

Status FrameFolder::write(const Start& start) {
  const CameraModel& c = start.calibration.camera;
  const auto& d = c.radtan;
  const std::string calib =
      fmt::format("# fx fy cx cy width height model d0..\n{} {} {} {} {} {} radtan {} {} {} {} {}\n", c.fx_px, c.fy_px,
                  c.cx_px, c.cy_px, c.width_px, c.height_px, d[0], d[1], d[2], d[3], d[4]);
  if (Status s = write_whole_file(directory_ + "/calib.txt", calib); !s.ok()) return s;
  if (Status s = write_whole_file(directory_ + "/calibration.toml", to_toml(start.calibration)); !s.ok()) return s;
  Config config = start.config;
  config.camera.source = "images:" + directory_;
  config.daemon.calibration = directory_ + "/calibration.toml";
  return write_whole_file(directory_ + "/box.toml", to_toml(config));
}

Status FrameFolder::write(const Frame& frame) {
  if (frame.encoded == nullptr) return Error{ErrorCode::kUnsupported, "frames are not compressed", directory_};
  const std::string name = fmt::format("images/{:06}.{}", frame.sequence, frame.encoding == "png" ? "png" : "jpg");
  times_ += fmt::format("{}.{:09} {}\n", frame.time.ns / 1'000'000'000, frame.time.ns % 1'000'000'000, name);
  return write_whole_file(directory_ + "/" + name,
                          {reinterpret_cast<const char*>(frame.encoded->data()), frame.encoded->size()});
}

Status FrameFolder::close() {
  if (times_.empty()) return Error{ErrorCode::kUnsupported, "the run has no frames", directory_};
  return write_whole_file(directory_ + "/times.txt", "# t[s] filename\n" + times_);
}

}  // namespace rfmvo
