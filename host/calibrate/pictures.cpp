#include "calibrate/pictures.hpp"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "edges/journal.hpp"

namespace rfmvo::calibrate {
namespace {

namespace fs = std::filesystem;
using Sink = std::function<Status(const cv::Mat&, const std::string&)>;

bool is_image(const fs::path& path) {
  static const std::set<std::string> kExtensions = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return kExtensions.count(extension) > 0;
}

Status read_image(const std::string& path, const Sink& sink) {
  const cv::Mat grey = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) return Error{ErrorCode::kUnreadable, "no picture that can be read", path};
  return sink(grey, fs::path(path).filename().string());
}

Status read_folder(const std::string& path, const Sink& sink) {
  std::set<std::string> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error))
    if (is_image(entry.path())) files.insert(entry.path().string());
  if (error) return Error{ErrorCode::kUnreadable, error.message(), path};
  if (files.empty()) return Error{ErrorCode::kNotFound, "holds no pictures (.png, .jpg, ...)", path};
  for (const std::string& file : files)
    if (Status s = read_image(file, sink); !s) return s;
  return Done{};
}

Status read_journal(const std::string& path, const PictureSources& sources, const Sink& sink) {
  auto reader = JournalReader::open(path, sources.prefix, {true});
  if (!reader) return reader.error();
  std::optional<DeviceTime> next_time;
  bool any = false;
  while (true) {
    auto event = reader.value()->next();
    if (!event) return event.error();
    if (!event.value()) break;
    const auto* frame = std::get_if<Frame>(&*event.value());
    if (frame == nullptr) continue;
    any = true;
    if (next_time && frame->time < *next_time) continue;
    next_time = frame->time + sources.every;
    const cv::Mat grey(frame->height_px, frame->width_px, CV_8UC1, const_cast<std::uint8_t*>(frame->grey->data()));
    if (Status s = sink(grey, "frame " + std::to_string(frame->sequence)); !s) return s;
  }
  return any ? Status(Done{}) : Status(Error{ErrorCode::kNotFound, "holds no frames", path});
}

}  // namespace

Status for_each_picture(const PictureSources& sources, const Sink& sink) {
  for (const std::string& input : sources.inputs) {
    std::error_code ignored;
    if (!fs::exists(input, ignored)) return Error{ErrorCode::kNotFound, "no such file or folder", input};
    const Status read = fs::is_directory(input, ignored)           ? read_folder(input, sink)
                        : fs::path(input).extension() == ".lcmlog" ? read_journal(input, sources, sink)
                                                                   : read_image(input, sink);
    if (!read) return read;
  }
  return Done{};
}

}  // namespace rfmvo::calibrate
