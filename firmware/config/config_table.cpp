#include "config/config_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

namespace rfmvo {
namespace {

template <auto Section, auto Member>
auto& at(Config& config) {
  return (config.*Section).*Member;
}

constexpr auto kEstimator = &Config::estimator;
constexpr auto kSync = &Config::sync;
constexpr auto kPaper = &Config::paper;
constexpr auto kJoint = &Config::joint;
constexpr auto kVision = &Config::vision;
constexpr auto kLcm = &Config::lcm;
constexpr auto kCamera = &Config::camera;
constexpr auto kReader = &Config::reader;
constexpr auto kJournal = &Config::journal;
constexpr auto kDaemon = &Config::daemon;

using E = EstimatorConfig;
using P = PaperConfig;
using J = JointConfig;
using V = VisionConfig;
using R = ReaderConfig;
using C = CameraConfig;
using L = JournalConfig;

// clang-format off
const ConfigRow kRows[] = {
    {"estimator.kind", "", &at<kEstimator, &E::kind>, 0, 0, "joint|paper",
     "which estimator runs: joint (near field, all tags, one scale) or paper (sections III to V to the letter)"},
    {"estimator.pose_source", "", &at<kEstimator, &E::pose_source>, 0, 0, "frames|poses",
     "where camera poses come from: frames (own visual odometry) or poses (camera poses of the event stream)"},
    {"estimator.publish_interval_s", "s", &at<kEstimator, &E::publish_interval_s>, 0.01, 3600, "",
     "estimates are published this often, in event time", true},

    {"sync.max_pose_gap_s", "s", &at<kSync, &SyncConfig::max_pose_gap_s>, 0.001, 10, "",
     "no interpolation across a longer gap between two camera poses"},

    {"paper.elements", "", &at<kPaper, &P::elements>, 4, 10000, "",
     "L, reads per antenna array"},
    {"paper.angle_step_deg", "deg", &at<kPaper, &P::angle_step_deg>, 0.1, 45, "",
     "step of alpha and beta in the spectrum search, Eq. (8)"},
    {"paper.scale_step", "", &at<kPaper, &P::scale_step>, 0.0001, 10, "",
     "step of gamma in the spectrum search, in units of the normalised scale"},
    {"paper.refine_step_deg", "deg", &at<kPaper, &P::refine_step_deg>, 0.01, 45, "",
     "step of alpha and beta in the refinement, Eq. (16)"},
    {"paper.refine_range_deg", "deg", &at<kPaper, &P::refine_range_deg>, 0, 90, "",
     "mu, half range of the refinement, Eq. (16)"},
    {"paper.max_speed_m_s", "m/s", &at<kPaper, &P::max_speed_m_s>, 0.01, 20, "",
     "highest speed of the cart, Eq. (5)"},
    {"paper.min_read_rate_hz", "Hz", &at<kPaper, &P::min_read_rate_hz>, 0.01, 10000, "",
     "lowest read rate of one tag, Eq. (5)"},
    {"paper.max_iterations", "", &at<kPaper, &P::max_iterations>, 1, 1000, "",
     "iterations of the joint optimization, at most"},
    {"paper.array_stride", "", &at<kPaper, &P::array_stride>, 1, 10000, "",
     "reads between the starts of two antenna arrays (1 in the paper)"},
    {"paper.fix_rotation", "", &at<kPaper, &P::fix_rotation>, 0, 0, "",
     "repair: antenna positions from the camera's rotation instead of the constant offset of Eq. (12)"},
    {"paper.fix_sphere_average", "", &at<kPaper, &P::fix_sphere_average>, 0, 0, "",
     "repair: average directions on the sphere instead of angles, Eq. (9) and (10)"},
    {"paper.fix_cycles", "", &at<kPaper, &P::fix_cycles>, 0, 0, "",
     "repair: whole cycles by rounding the prediction instead of Eq. (21) and (22)"},
    {"paper.fix_scale_range", "", &at<kPaper, &P::fix_scale_range>, 0, 0, "",
     "repair: search limits of gamma that noise and missed reads cannot push past the truth"},

    {"joint.structured_sigma_rad", "rad", &at<kJoint, &J::structured_sigma_rad>, 0, 10, "",
     "smooth phase error (multipath, antenna pattern), 1 sigma, before it is estimated"},
    {"joint.structured_sigma_floor_rad", "rad", &at<kJoint, &J::structured_sigma_floor_rad>, 0, 10, "",
     "the estimated smooth phase error is never taken as smaller, 1 sigma"},
    {"joint.correlation_length_m", "m", &at<kJoint, &J::correlation_length_m>, 0.001, 10, "",
     "Matern 3/2 length of the smooth phase error along the antenna's path"},
    {"joint.flip_probability", "", &at<kJoint, &J::flip_probability>, 0, 0.5, "",
     "probability that the reader reports a phase that is wrong by pi"},
    {"joint.outlier_probability", "", &at<kJoint, &J::outlier_probability>, 1e-6, 0.9, "",
     "probability that a reported phase tells nothing about the tag"},
    {"joint.tag_range_max_m", "m", &at<kJoint, &J::tag_range_max_m>, 0.1, 100, "",
     "tags farther than this from the path are not looked for"},
    {"joint.scale_min_m", "m", &at<kJoint, &J::scale_min_m>, 1e-6, 1e6, "",
     "smallest scale that is looked for: metres per unit of the visual odometry"},
    {"joint.scale_max_m", "m", &at<kJoint, &J::scale_max_m>, 1e-6, 1e6, "",
     "largest scale that is looked for: metres per unit of the visual odometry"},
    {"joint.scale_sigma_max", "", &at<kJoint, &J::scale_sigma_max>, 0.001, 10, "",
     "the scale counts as observable below this relative error, 1 sigma"},
    {"joint.speed_min_m_s", "m/s", &at<kJoint, &J::speed_min_m_s>, 1e-4, 100, "",
     "smallest mean speed of the cart that the search for the scale considers"},
    {"joint.speed_max_m_s", "m/s", &at<kJoint, &J::speed_max_m_s>, 1e-3, 100, "",
     "largest mean speed of the cart that the search for the scale considers"},
    {"joint.time_offset_sigma_s", "s", &at<kJoint, &J::time_offset_sigma_s>, 1e-6, 1, "",
     "camera against reader after the clocks are matched, 1 sigma"},
    {"joint.stale_after_s", "s", &at<kJoint, &J::stale_after_s>, 1, 1e9, "",
     "a tag that was not read for longer is stale"},
    {"joint.knot_spacing_m", "m", &at<kJoint, &J::knot_spacing_m>, 0.001, 100, "",
     "distance between the path's correction knots"},
    {"joint.located_sigma_max_m", "m", &at<kJoint, &J::located_sigma_max_m>, 0.001, 100, "",
     "a tag whose sigma is above this has weak geometry"},
    {"joint.vo_scale_walk_per_sqrt_m", "1/sqrt(m)", &at<kJoint, &J::vo_scale_walk_per_sqrt_m>, 0, 10, "",
     "random walk of the odometry's scale, relative, 1 sigma after 1 m"},
    {"joint.vo_rotation_walk_deg_per_sqrt_m", "deg/sqrt(m)", &at<kJoint, &J::vo_rotation_walk_deg_per_sqrt_m>, 0, 90, "",
     "random walk of the odometry's rotation, 1 sigma after 1 m"},
    {"joint.vo_position_walk_m_per_sqrt_m", "m/sqrt(m)", &at<kJoint, &J::vo_position_walk_m_per_sqrt_m>, 1e-6, 10, "",
     "random walk of the odometry's position beside those of scale and rotation, 1 sigma after 1 m"},
    {"joint.vo_position_sigma_m", "m", &at<kJoint, &J::vo_position_sigma_m>, 0, 10, "",
     "white position error of each camera pose, 1 sigma"},

    {"vision.max_tracks", "", &at<kVision, &V::max_tracks>, 8, 10000, "",
     "image points that are followed at a time"},
    {"vision.window_keyframes", "", &at<kVision, &V::window_keyframes>, 2, 1000, "",
     "keyframes in the bundle adjustment"},
    {"vision.min_parallax_deg", "deg", &at<kVision, &V::min_parallax_deg>, 0, 90, "",
     "smallest parallax of a new map point"},
    {"vision.reprojection_gate_px", "px", &at<kVision, &V::reprojection_gate_px>, 0.01, 100, "",
     "a point that is farther from its prediction is an outlier"},
    {"vision.k1_sigma", "", &at<kVision, &V::k1_sigma>, 0, 1, "",
     "how far a lens whose calibration states no distortion may be from k1 = 0, 1 sigma; 0: no self-calibration"},
    {"vision.readout_s", "s", &at<kVision, &V::readout_s>, -0.1, 0.1, "",
     "time from reading a picture's first row to its last (rolling shutter); 0: global shutter"},
    {"vision.readout_sigma_s", "s", &at<kVision, &V::readout_sigma_s>, 0, 0.1, "",
     "how far the true readout time may be from that, 1 sigma; 0: no self-calibration"},

    {"lcm.url", "", &at<kLcm, &LcmConfig::url>, 0, 0, "",
     "where estimates are published; ttl=0 stays on this machine"},
    {"lcm.prefix", "", &at<kLcm, &LcmConfig::prefix>, 0, 0, "",
     "before every channel name, on the bus and in logs"},

    {"camera.source", "", &at<kCamera, &C::source>, 0, 0, "",
     "v4l2:DEVICE (such as v4l2:/dev/video0), libcamera:ID (libcamera: is the first one), images:DIR (a folder with images/, "
     "times.txt, calib.txt) or journal:FILE (all events of a journal)"},
    {"camera.start_time_s", "s", &at<kCamera, &C::start_time_s>, 0, 9e9, "",
     "images are played live and the first one is of this time since 1970; 0: as recorded, as fast as they can be used"},
    {"camera.width_px", "px", &at<kCamera, &C::width_px>, 16, 8192, "",
     "width of the pictures that the camera takes, before crop"},
    {"camera.height_px", "px", &at<kCamera, &C::height_px>, 16, 8192, "",
     "height of the pictures that the camera takes, before crop"},
    {"camera.frame_rate_hz", "Hz", &at<kCamera, &C::frame_rate_hz>, 0, 1000, "",
     "pictures per second; 0: the camera's own"},
    {"camera.exposure_s", "s", &at<kCamera, &C::exposure_s>, 0, 1, "",
     "exposure time of each picture; 0: automatic", true},
    {"camera.gain", "", &at<kCamera, &C::gain>, 0, 1e6, "",
     "analogue gain: a factor with libcamera, the driver's own unit with V4L2; 0: automatic", true},
    {"camera.format", "", &at<kCamera, &C::format>, 0, 0, "auto|grey|nv12|yuv420|yuyv|mjpg",
     "how pictures come from the camera; auto: the first of these that it has"},
    {"camera.flip", "", &at<kCamera, &C::flip>, 0, 0, "none|horizontal|vertical|both",
     "mirrors pictures left to right (horizontal), top to bottom (vertical), or turns them by 180 degrees (both), after the crop"},
    {"camera.crop_x_px", "px", &at<kCamera, &C::crop_x_px>, 0, 8191, "",
     "left edge of the part that is used"},
    {"camera.crop_y_px", "px", &at<kCamera, &C::crop_y_px>, 0, 8191, "",
     "upper edge of the part that is used"},
    {"camera.crop_width_px", "px", &at<kCamera, &C::crop_width_px>, 0, 8192, "",
     "width of the part that is used; 0: to the right edge"},
    {"camera.crop_height_px", "px", &at<kCamera, &C::crop_height_px>, 0, 8192, "",
     "height of the part that is used; 0: to the lower edge"},
    {"camera.time_offset_s", "s", &at<kCamera, &C::time_offset_s>, -1, 1, "",
     "added to the time of every picture: what is known of the driver's delay"},
    {"camera.stall_s", "s", &at<kCamera, &C::stall_s>, 0.05, 60, "",
     "a camera that gives no picture for longer is started anew"},

    {"reader.backend", "", &at<kReader, &R::backend>, 0, 0, "own|ltkcpp",
     "what speaks to the reader: own, or the LLRP Toolkit's C++ library if this program was built with it"},
    {"reader.address", "", &at<kReader, &R::address>, 0, 0, "",
     "name or IPv4 or IPv6 address of the RFID reader; empty: no reader"},
    {"reader.port", "", &at<kReader, &R::port>, 0, 65535, "",
     "TCP port of the reader; 0: 5084, with TLS 5085"},
    {"reader.tls", "", &at<kReader, &R::tls>, 0, 0, "",
     "encrypt the connection"},
    {"reader.tls_ca", "", &at<kReader, &R::tls_ca>, 0, 0, "",
     "PEM file of the certificates to trust; empty: any certificate is taken, so the reader is not authenticated"},
    {"reader.antennas", "", &at<kReader, &R::antennas>, 0, 0, "",
     "antenna ports to read with, such as 1,2; empty: those of the calibration"},
    {"reader.phase_sign", "", &at<kReader, &R::phase_sign>, 0, 0, "grows|falls",
     "whether the phase that the reader reports grows or falls with distance"},
    {"reader.mode", "", &at<kReader, &R::mode>, -1, 65535, "",
     "reader mode, of the reader's own table; a fixed one is best for phase; -1: 2 if there is, else the first fixed one"},
    {"reader.session", "", &at<kReader, &R::session>, 0, 3, "",
     "Gen2 session; 0 and 1 give repeated reads"},
    {"reader.power_dbm", "dBm", &at<kReader, &R::power_dbm>, 0, 36, "",
     "power at the antenna port, the reader's next lower step; 0: its highest"},
    {"reader.hop_table", "", &at<kReader, &R::hop_table>, 0, 255, "",
     "which of the reader's own hop tables; 0: its first"},
    {"reader.channel", "", &at<kReader, &R::channel>, 0, 65535, "",
     "channel of a reader that does not hop, counted from 1 in its own table; 0: its first"},
    {"reader.keepalive_s", "s", &at<kReader, &R::keepalive_s>, 0.1, 60, "",
     "the reader must show a sign of life this often; after three without, it is connected anew"},

    {"journal.directory", "", &at<kJournal, &L::directory>, 0, 0, "",
     "folder of the journals; empty: no journal"},
    {"journal.quota_mb", "MB", &at<kJournal, &L::quota_mb>, 0, 1e8, "",
     "all journals in the folder together; the oldest segments make room for new ones; 0: no limit"},
    {"journal.segment_mb", "MB", &at<kJournal, &L::segment_mb>, 1, 100'000, "",
     "a journal goes on in a new file after so much"},
    {"journal.flush_s", "s", &at<kJournal, &L::flush_s>, 0.001, 10, "",
     "what was written is on the disk after so long: what a power failure can take"},
    {"journal.queue_mb", "MB", &at<kJournal, &L::queue_mb>, 1, 100'000, "",
     "what may wait for a slow card before the oldest frames are dropped"},
    {"journal.frames", "", &at<kJournal, &L::frames>, 0, 0, "raw|jpeg",
     "frames of a camera in the journal: raw, or jpeg (smaller; the estimator then sees what the journal holds)"},
    {"journal.jpeg_quality", "", &at<kJournal, &L::jpeg_quality>, 1, 100, "",
     "of journal.frames = \"jpeg\""},

    {"daemon.calibration", "", &at<kDaemon, &DaemonConfig::calibration>, 0, 0, "",
     "TOML file with camera, mounting and antennas"},
    {"daemon.key_file", "", &at<kDaemon, &DaemonConfig::key_file>, 0, 0, "",
     "file with the shared key that remote changes of the configuration must be signed with; empty: there are none"},
};
// clang-format on

std::string number_text(double x) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x).ptr;
  return {buffer.data(), end};
}

std::string value_text(const ConfigValue& value) {
  if (const auto* real = std::get_if<double>(&value)) return "the number " + number_text(*real);
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return "the number " + std::to_string(*integer);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return "the text \"" + std::get<std::string>(value) + "\"";
}

std::string expectation(const ConfigRow& row) {
  const std::string in_unit = row.unit.empty() ? "" : " in " + std::string(row.unit);
  if (std::holds_alternative<ConfigRow::Real>(row.member)) return "a number" + in_unit;
  if (std::holds_alternative<ConfigRow::Integer>(row.member)) return "a whole number" + in_unit;
  if (std::holds_alternative<ConfigRow::Flag>(row.member)) return "true or false";
  return row.choices.empty() ? "a text" : "one of " + std::string(row.choices);
}

Error wrong_type(const ConfigRow& row, const ConfigValue& value) {
  return {ErrorCode::kMalformed, "expects " + expectation(row) + ", not " + value_text(value), std::string(row.key)};
}

Status check_range(const ConfigRow& row, double x) {
  if (std::isfinite(x) && x >= row.min && x <= row.max) return Done{};
  const std::string unit = row.unit.empty() ? "" : " " + std::string(row.unit);
  return Error{ErrorCode::kOutOfRange,
               number_text(x) + " is outside " + number_text(row.min) + " to " + number_text(row.max) + unit,
               std::string(row.key)};
}

bool is_choice(std::string_view choices, std::string_view text) {
  while (true) {
    const std::size_t bar = choices.find('|');
    if (choices.substr(0, bar) == text) return true;
    if (bar == std::string_view::npos) return false;
    choices.remove_prefix(bar + 1);
  }
}

Status set_text(const ConfigRow& row, std::string& member, const std::string& text) {
  if (!row.choices.empty() && !is_choice(row.choices, text)) return wrong_type(row, text);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (text.size() > kMaxTextLength || std::any_of(text.begin(), text.end(), is_control))
    return Error{ErrorCode::kOutOfRange, "a text of at most " + std::to_string(kMaxTextLength) +
                 " bytes without control characters is expected", std::string(row.key)};
  member = text;
  return Done{};
}

// Levenshtein's edit distance.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string_view nearest_of(std::string_view key, std::span<const std::string_view> known) {
  RFMVO_ASSERT(!known.empty());
  key = key.substr(0, kMaxTextLength);
  return *std::min_element(known.begin(), known.end(), [key](std::string_view a, std::string_view b) {
    return distance(key, a) < distance(key, b);
  });
}

// The whole text as a number.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::span<const ConfigRow> config_rows() { return kRows; }

const ConfigRow* find_row(std::string_view key) {
  for (const ConfigRow& row : kRows)
    if (row.key == key) return &row;
  return nullptr;
}

Error unknown_key(std::string_view key, std::span<const std::string_view> known) {
  return {ErrorCode::kUnknownKey, "unknown key; did you mean " + std::string(nearest_of(key, known)) + "?",
          std::string(key.substr(0, kMaxTextLength))};
}

Status set_value(Config& config, std::string_view key, const ConfigValue& value) {
  const ConfigRow* row = find_row(key);
  if (row == nullptr) {
    std::vector<std::string_view> known;
    for (const ConfigRow& r : kRows) known.push_back(r.key);
    return unknown_key(key, known);
  }
  const auto* real = std::get_if<double>(&value);
  const auto* integer = std::get_if<std::int64_t>(&value);
  if (const auto* member = std::get_if<ConfigRow::Real>(&row->member)) {
    if (real == nullptr && integer == nullptr) return wrong_type(*row, value);
    const double x = real != nullptr ? *real : static_cast<double>(*integer);
    if (const Status range = check_range(*row, x); !range) return range;
    (*member)(config) = x;
  } else if (const auto* count = std::get_if<ConfigRow::Integer>(&row->member)) {
    if (integer == nullptr) return wrong_type(*row, value);
    if (const Status range = check_range(*row, static_cast<double>(*integer)); !range) return range;
    (*count)(config) = *integer;
  } else if (const auto* flag = std::get_if<ConfigRow::Flag>(&row->member)) {
    if (!std::holds_alternative<bool>(value)) return wrong_type(*row, value);
    (*flag)(config) = std::get<bool>(value);
  } else {
    if (!std::holds_alternative<std::string>(value)) return wrong_type(*row, value);
    return set_text(*row, std::get<ConfigRow::Text>(row->member)(config), std::get<std::string>(value));
  }
  return Done{};
}

Status set_value_from_text(Config& config, std::string_view key, std::string_view text) {
  const ConfigRow* row = find_row(key);
  if (row != nullptr && std::holds_alternative<ConfigRow::Flag>(row->member) && (text == "true" || text == "false"))
    return set_value(config, key, text == "true");
  if (row != nullptr && !std::holds_alternative<ConfigRow::Text>(row->member)) {
    if (const auto integer = parse_number<std::int64_t>(text)) return set_value(config, key, *integer);
    if (const auto real = parse_number<double>(text)) return set_value(config, key, *real);
  }
  return set_value(config, key, std::string(text));
}

Status check_consistency(const Config& config) {
  if (config.joint.scale_min_m >= config.joint.scale_max_m)
    return Error{ErrorCode::kOutOfRange, "must be below joint.scale_max_m", "joint.scale_min_m"};
  const CameraConfig& camera = config.camera;
  if (camera.crop_x_px + std::max<std::int64_t>(camera.crop_width_px, 1) > camera.width_px)
    return Error{ErrorCode::kOutOfRange, "the crop reaches beyond camera.width_px", "camera.crop_x_px"};
  if (camera.crop_y_px + std::max<std::int64_t>(camera.crop_height_px, 1) > camera.height_px)
    return Error{ErrorCode::kOutOfRange, "the crop reaches beyond camera.height_px", "camera.crop_y_px"};
  return Done{};
}

ConfigValue get_value(const Config& config, const ConfigRow& row) {
  // The accessors give writable references; nothing is written here.
  auto& c = const_cast<Config&>(config);
  return std::visit([&c](auto member) -> ConfigValue { return member(c); }, row.member);
}

}  // namespace rfmvo
