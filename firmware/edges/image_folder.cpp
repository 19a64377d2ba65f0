#include "edges/image_folder.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "edges/camera_file.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/text_file.hpp"

namespace rfmvo {
namespace {

constexpr std::uintmax_t kMaxImageFileBytes = std::uintmax_t{1} << 27;  // as in the journal
constexpr double kMaxTime_s = 9e9;                                      // year 2255; fits nanoseconds

struct Entry {
  DeviceTime time;
  std::string path;
  std::string encoding;
};

Error at_line(const std::string& path, std::size_t line, const std::string& what) {
  return {ErrorCode::kMalformed, what, path + ":" + std::to_string(line)};
}

// Lines that hold something, with their numbers from 1.
Result<std::vector<std::pair<std::size_t, std::string>>> lines_of(const std::string& path) {
  auto text = read_text_file(path);
  if (!text) return text.error();
  std::vector<std::pair<std::size_t, std::string>> lines;
  std::istringstream stream(text.value());
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first != std::string::npos && line[first] != '#') lines.emplace_back(number, line);
  }
  return lines;
}

// calib.txt, or a calibration of another tool where there is none.
Result<CameraModel> read_camera(const std::string& directory) {
  for (const char* name : {"camchain.yaml", "camera_info.yaml", "calibration.yaml", "camera.yaml", "calib.yaml"}) {
    const std::string path = directory + "/" + name;
    if (!std::filesystem::exists(directory + "/calib.txt") && std::filesystem::exists(path))
      return read_camera_file(path);
  }
  return read_camera_line(directory + "/calib.txt");
}

std::string encoding_of(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".png") return "png";
  return extension == ".jpg" || extension == ".jpeg" ? "jpeg" : "";
}

Result<std::vector<Entry>> read_times(const std::string& directory) {
  const std::string path = directory + "/times.txt";
  const auto lines = lines_of(path);
  if (!lines) return lines.error();
  std::vector<Entry> entries;
  for (const auto& [number, line] : lines.value()) {
    std::istringstream fields(line);
    double t_s = 0.0;
    std::string name, rest;
    if (!(fields >> t_s >> name) || (fields >> rest) || !(std::abs(t_s) <= kMaxTime_s))
      return at_line(path, number, "expects: time in seconds, file name");
    Entry entry{{Duration::from_seconds(t_s).ns}, directory + "/" + name, encoding_of(name)};
    if (entry.encoding.empty()) return at_line(path, number, "\"" + name + "\" is neither .png nor .jpg");
    if (!entries.empty() && entry.time <= entries.back().time) return at_line(path, number, "times do not increase");
    entries.push_back(std::move(entry));
  }
  if (entries.empty()) return Error{ErrorCode::kMalformed, "names no image", path};
  return entries;
}

Result<std::shared_ptr<const std::vector<std::uint8_t>>> read_bytes(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return Error{ErrorCode::kNotFound, "cannot be read: " + error.message(), path};
  if (size == 0 || size > kMaxImageFileBytes) return Error{ErrorCode::kMalformed, "empty, or larger than 128 MB", path};
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(static_cast<std::size_t>(size));
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes->data()), static_cast<std::streamsize>(size)))
    return Error{ErrorCode::kUnreadable, std::string("cannot be read: ") + std::strerror(errno), path};
  return std::shared_ptr<const std::vector<std::uint8_t>>(std::move(bytes));
}

}  // namespace

Result<CameraModel> read_camera_line(const std::string& path) {
  const auto lines = lines_of(path);
  if (!lines) return lines.error();
  if (lines.value().size() != 1)
    return Error{ErrorCode::kMalformed, "expects one line: fx fy cx cy width height model d0 d1 ...", path};
  const auto& [number, line] = lines.value().front();
  std::istringstream fields(line);
  CameraModel c;
  std::string model;
  fields >> c.fx_px >> c.fy_px >> c.cx_px >> c.cy_px >> c.width_px >> c.height_px >> model;
  if (!fields || c.fx_px <= 0 || c.fy_px <= 0 || c.width_px < 1 || c.height_px < 1)
    return at_line(path, number, "expects fx fy cx cy width height model d0 d1 ..., in px");
  const bool fisheye = model == "equidistant";
  if (model != "radtan" && model != "none" && !fisheye)
    return at_line(path, number, "unknown camera model \"" + model + "\"; known: radtan, equidistant, none");
  if (fisheye) c.distortion = Distortion::kEquidistant;
  std::size_t count = 0;
  for (double d = 0.0; fields >> d; ++count) {
    if (count >= (fisheye ? c.equidistant.size() : c.radtan.size()) || model == "none")
      return at_line(path, number, "too many distortion numbers");
    (fisheye ? c.equidistant[count] : c.radtan[count]) = d;
  }
  if (fisheye && count != 4) return at_line(path, number, "equidistant expects 4 distortion numbers: k1 k2 k3 k4");
  if (!fields.eof() || (model == "radtan" && count < 4))
    return at_line(path, number, "radtan expects 4 or 5 distortion numbers: k1 k2 p1 p2 [k3]");
  return c;
}

struct ImageFolder::Impl {
  CameraModel camera;
  std::vector<Entry> entries;
  std::size_t next = 0;
  bool started = false;
};

ImageFolder::ImageFolder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ImageFolder::~ImageFolder() = default;

Result<std::unique_ptr<ImageFolder>> ImageFolder::open(const std::string& directory) {
  auto camera = read_camera(directory);
  if (!camera) return camera.error();
  auto entries = read_times(directory);
  if (!entries) return entries.error();
  auto impl = std::make_unique<Impl>();
  impl->camera = camera.value();
  impl->entries = std::move(entries).value();
  return std::unique_ptr<ImageFolder>(new ImageFolder(std::move(impl)));
}

const CameraModel& ImageFolder::camera() const { return impl_->camera; }

Result<std::optional<Event>> ImageFolder::next() {
  if (!impl_->started) {
    impl_->started = true;
    Start start;
    start.time = impl_->entries.front().time;
    start.calibration.camera = impl_->camera;
    return std::optional<Event>(std::move(start));
  }
  if (impl_->next == impl_->entries.size()) return std::optional<Event>();
  const Entry& entry = impl_->entries[impl_->next];
  auto bytes = read_bytes(entry.path);
  if (!bytes) return bytes.error();
  Frame frame;
  frame.time = entry.time;
  frame.sequence = static_cast<std::int64_t>(impl_->next);
  frame.width_px = impl_->camera.width_px;
  frame.height_px = impl_->camera.height_px;
  frame.encoding = entry.encoding;
  frame.encoded = std::move(bytes).value();
  if (const Status s = decode_image(frame); !s) return Error{s.error().code, s.error().what, entry.path};
  ++impl_->next;
  return std::optional<Event>(std::move(frame));
}

}  // namespace rfmvo
