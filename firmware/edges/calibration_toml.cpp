#include <algorithm>
#include <cmath>
#include <vector>

#include "config/config_table.hpp"
#include "edges/text_file.hpp"
#include "edges/toml_files.hpp"
#include "edges/toml_parts.hpp"

namespace rfmvo {
namespace {

using namespace toml_parts;

constexpr double kMaxSide_px = 16384;
constexpr double kMaxFocalLength_px = 1e6;
constexpr double kMaxDistortion = 100;
constexpr double kMaxArm_m = 10;  // a larger one was written in mm
constexpr double kMaxElectricalLength_m = 200;
constexpr std::size_t kMaxAntennas = 32;
// What a hand-written unit vector may be off; it is normalised. Below kExact it is left alone, so that
// what we wrote comes back to the last bit.
constexpr double kUnitTolerance = 1e-3;
constexpr double kExact = 1e-12;

// One table of the file. Remembers the first error, so that reading code stays a list of keys.
class Section {
 public:
  Section(const toml::table& table, std::string name, const std::string& where)
      : table_(table), name_(std::move(name)), where_(where) {}

  double number(std::string_view key, std::string_view unit, double min, double max, double fallback) {
    const toml::node* node = find(key);
    if (node == nullptr || error_) return fallback;
    const auto value = node->is_number() ? node->value<double>() : std::nullopt;
    if (!value) return fail(key, *node, "expects a number" + in(unit)), fallback;
    return checked(key, *node, *value, unit, min, max, fallback);
  }

  int whole(std::string_view key, std::string_view unit, int min, int max, int fallback) {
    const toml::node* node = find(key);
    if (node == nullptr || error_) return fallback;
    if (!node->is_integer()) return fail(key, *node, "expects a whole number" + in(unit)), fallback;
    const auto value = static_cast<double>(node->as_integer()->get());
    return static_cast<int>(checked(key, *node, value, unit, min, max, fallback));
  }

  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key, std::string_view unit, double max,
                                std::array<double, N> fallback) {
    const toml::node* node = find(key);
    if (node == nullptr || error_) return fallback;
    const auto list = list_of_numbers<N>(key, *node, unit, -max, max);
    if (!list) return fail(key, *node, "expects a list of " + std::to_string(N) + " numbers" + in(unit)), fallback;
    return *list;
  }

  // A number for all three axes, or one for each.
  Eigen::Vector3d one_or_three(std::string_view key, std::string_view unit, double max,
                               const Eigen::Vector3d& fallback) {
    const toml::node* node = find(key);
    if (node == nullptr || error_) return fallback;
    if (node->is_number()) return Eigen::Vector3d::Constant(number(key, unit, 0, max, fallback.x()));
    const auto list = list_of_numbers<3>(key, *node, unit, 0, max);
    if (!list) return fail(key, *node, "expects a number or a list of three" + in(unit)), fallback;
    return {(*list)[0], (*list)[1], (*list)[2]};
  }

  // One of two; the first if the key is missing.
  std::string text(std::string_view key, std::string_view first, std::string_view second) {
    const toml::node* node = find(key);
    if (node == nullptr || error_) return std::string(first);
    if (node->is_string() && (node->as_string()->get() == first || node->as_string()->get() == second))
      return node->as_string()->get();
    fail(key, *node, "expects \"" + std::string(first) + "\" or \"" + std::string(second) + "\"");
    return std::string(first);
  }

  template <std::size_t N>
  std::array<double, N> unit_vector(std::string_view key, std::array<double, N> fallback) {
    std::array<double, N> v = numbers<N>(key, "", 1.0 + kUnitTolerance, fallback);
    if (error_) return fallback;
    double squared = 0.0;
    for (const double x : v) squared += x * x;
    const double off = std::abs(std::sqrt(squared) - 1.0);
    if (off > kUnitTolerance) fail(key, *find(key), "expects length 1, not " + text_of(std::sqrt(squared)));
    if (off > kExact)
      for (double& x : v) x /= std::sqrt(squared);
    return v;
  }

  void require(std::string_view key) {
    if (error_ || find(key) != nullptr) return;
    error_ = Error{ErrorCode::kMalformed, full(key) + ": is missing", place(where_, table_)};
  }

  // Every key of the table must have been asked for.
  void reject_unknown() {
    for (const auto& [key, node] : table_) {
      if (error_) return;
      if (std::find(asked_.begin(), asked_.end(), key.str()) != asked_.end()) continue;
      const Error unknown = unknown_key(key.str(), asked_);
      error_ = Error{unknown.code, full(key.str()) + ": " + unknown.what, place(where_, node)};
    }
  }

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  const toml::node* find(std::string_view key) {
    asked_.push_back(key);
    return table_.get(key);
  }
  [[nodiscard]] std::string full(std::string_view key) const { return name_ + "." + std::string(key); }
  static std::string in(std::string_view unit) { return unit.empty() ? "" : " in " + std::string(unit); }

  void fail(std::string_view key, const toml::node& node, const std::string& what) {
    if (!error_) error_ = Error{ErrorCode::kMalformed, full(key) + ": " + what, place(where_, node)};
  }

  // Nothing if it is no list of N numbers.
  template <std::size_t N>
  std::optional<std::array<double, N>> list_of_numbers(std::string_view key, const toml::node& node,
                                                       std::string_view unit, double min, double max) {
    const toml::array* list = node.as_array();
    if (list == nullptr || list->size() != N) return std::nullopt;
    std::array<double, N> out{};
    for (std::size_t i = 0; i < N; ++i) {
      if (!list->get(i)->is_number()) return std::nullopt;
      out[i] = checked(key, node, *list->get(i)->value<double>(), unit, min, max, 0.0);
    }
    return out;
  }

  double checked(std::string_view key, const toml::node& node, double x, std::string_view unit, double min, double max,
                 double fallback) {
    if (std::isfinite(x) && x >= min && x <= max) return x;
    const std::string shown = std::isfinite(x) ? text_of(x) : "a number that is not finite";
    if (!error_)
      error_ = Error{ErrorCode::kOutOfRange,
                     full(key) + ": " + shown + " is outside " + text_of(min) + " to " + text_of(max) +
                         (unit.empty() ? "" : " " + std::string(unit)),
                     place(where_, node)};
    return fallback;
  }

  const toml::table& table_;
  std::string name_;
  const std::string& where_;
  std::vector<std::string_view> asked_;
  std::optional<Error> error_;
};

Result<CameraModel> camera_of(const toml::table& table, const std::string& where) {
  Section s(table, "camera", where);
  for (const char* key : {"width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px"}) s.require(key);
  CameraModel c;
  const std::string model = s.text("model", "radtan", "equidistant");
  if (model == "equidistant") c.distortion = Distortion::kEquidistant;
  c.width_px = s.whole("width_px", "px", 1, static_cast<int>(kMaxSide_px), c.width_px);
  c.height_px = s.whole("height_px", "px", 1, static_cast<int>(kMaxSide_px), c.height_px);
  c.fx_px = s.number("fx_px", "px", 1, kMaxFocalLength_px, c.fx_px);
  c.fy_px = s.number("fy_px", "px", 1, kMaxFocalLength_px, c.fy_px);
  c.cx_px = s.number("cx_px", "px", -kMaxSide_px, 2 * kMaxSide_px, c.cx_px);
  c.cy_px = s.number("cy_px", "px", -kMaxSide_px, 2 * kMaxSide_px, c.cy_px);
  c.radtan = s.numbers<5>("radtan", "", kMaxDistortion, c.radtan);
  c.equidistant = s.numbers<4>("equidistant", "", kMaxDistortion, c.equidistant);
  s.reject_unknown();
  if (s.error()) return *s.error();
  return c;
}

// Writes T_B_C and how well it is known.
Status read_mounting(const toml::table& table, const std::string& where, Calibration& calibration) {
  Section s(table, "mounting", where);
  const Rigid3 standard = Calibration{}.T_B_C;
  const auto& q = standard.R;
  const auto t = s.numbers<3>("translation_m", "m", kMaxArm_m, {standard.t.x(), standard.t.y(), standard.t.z()});
  const auto r = s.unit_vector<4>("quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()});
  calibration.camera_sigma_m = s.number("camera_sigma_m", "m", 0, kMaxArm_m, calibration.camera_sigma_m);
  constexpr double kMaxTurn_rad = 0.5;
  calibration.camera_rotation_sigma_rad =
      s.number("camera_rotation_sigma_rad", "rad", 0, kMaxTurn_rad, calibration.camera_rotation_sigma_rad);
  s.reject_unknown();
  if (s.error()) return *s.error();
  calibration.T_B_C = {Eigen::Quaterniond(r[0], r[1], r[2], r[3]), Eigen::Vector3d(t[0], t[1], t[2])};
  return Done{};
}

Result<AntennaCalibration> antenna_of(const toml::table& table, const std::string& where) {
  Section s(table, "antenna", where);
  s.require("port");
  s.require("p_C_A_m");
  AntennaCalibration a;
  a.port = static_cast<std::uint8_t>(s.whole("port", "", 1, 255, 1));
  const auto p = s.numbers<3>("p_C_A_m", "m", kMaxArm_m, {0.0, 0.0, 0.0});
  const auto b = s.unit_vector<3>("boresight_C", {0.0, 0.0, 1.0});
  a.p_C_A_m = {p[0], p[1], p[2]};
  a.boresight_C = {b[0], b[1], b[2]};
  a.lever_arm_sigma_m = s.one_or_three("lever_arm_sigma_m", "m", kMaxArm_m, a.lever_arm_sigma_m);
  a.electrical_length_m = s.number("electrical_length_m", "m", -kMaxElectricalLength_m, kMaxElectricalLength_m, 0.0);
  a.electrical_length_sigma_m =
      s.number("electrical_length_sigma_m", "m", 0, kMaxElectricalLength_m, a.electrical_length_sigma_m);
  s.reject_unknown();
  if (s.error()) return *s.error();
  return a;
}

Result<std::vector<AntennaCalibration>> antennas_of(const toml::node& node, const std::string& where) {
  std::vector<AntennaCalibration> antennas;
  const toml::array* list = node.as_array();
  if (list == nullptr || !list->is_array_of_tables() || list->size() > kMaxAntennas)
    return Error{ErrorCode::kMalformed, "antenna: expects 1 to 32 tables, each headed [[antenna]]", place(where, node)};
  for (const toml::node& element : *list) {
    auto antenna = antenna_of(*element.as_table(), where);
    if (!antenna) return antenna.error();
    for (const AntennaCalibration& other : antennas)
      if (other.port == antenna.value().port)
        return Error{ErrorCode::kMalformed, "antenna.port: " + std::to_string(other.port) + " is there twice",
                     place(where, element)};
    antennas.push_back(antenna.value());
  }
  return antennas;
}

std::string list_of(std::initializer_list<double> values) {
  std::string text;
  for (const double x : values) text += (text.empty() ? "[" : ", ") + text_of(x);
  return text + "]";
}

std::string list_of(const Eigen::Vector3d& v) { return list_of({v.x(), v.y(), v.z()}); }

}  // namespace

Result<Calibration> parse_calibration(std::string_view toml, const std::string& where) {
  auto document = parse_document(toml, where);
  if (!document) return document.error();
  static constexpr std::string_view kSections[] = {"camera", "mounting", "antenna"};
  Calibration calibration;
  for (const auto& [name, node] : document.value()) {
    const toml::table* table = node.as_table();
    if (name == "antenna") {
      auto antennas = antennas_of(node, where);
      if (!antennas) return antennas.error();
      calibration.antennas = std::move(antennas).value();
    } else if (name == "camera" && table != nullptr) {
      auto camera = camera_of(*table, where);
      if (!camera) return camera.error();
      calibration.camera = camera.value();
    } else if (name == "mounting" && table != nullptr) {
      if (const Status mounting = read_mounting(*table, where, calibration); !mounting) return mounting.error();
    } else {
      const Error error = unknown_key(name.str(), kSections);
      return Error{error.code, error.text(), place(where, node)};
    }
  }
  if (!document.value().contains("camera")) return Error{ErrorCode::kMalformed, "camera: is missing", where};
  return calibration;
}

Result<Calibration> read_calibration(const std::string& path) {
  auto text = read_text_file(path);
  if (!text) return text.error();
  return parse_calibration(text.value(), path);
}

std::string to_toml(const Calibration& calibration) {
  const CameraModel& c = calibration.camera;
  const Eigen::Quaterniond& q = calibration.T_B_C.R;
  const bool fisheye = c.distortion == Distortion::kEquidistant;
  std::string out = std::string("[camera]\nmodel = ") + (fisheye ? "\"equidistant\"\n" : "\"radtan\"\n");
  out += "width_px = " + std::to_string(c.width_px) + "\nheight_px = " + std::to_string(c.height_px) + "\n";
  out += "fx_px = " + text_of(c.fx_px) + "\nfy_px = " + text_of(c.fy_px) + "\n";
  out += "cx_px = " + text_of(c.cx_px) + "\ncy_px = " + text_of(c.cy_px) + "\n";
  if (fisheye) {
    out += "# k1, k2, k3, k4\nequidistant = " +
           list_of({c.equidistant[0], c.equidistant[1], c.equidistant[2], c.equidistant[3]}) + "\n";
  }
  out += "# k1, k2, p1, p2, k3\n";
  out += "radtan = " + list_of({c.radtan[0], c.radtan[1], c.radtan[2], c.radtan[3], c.radtan[4]}) + "\n";
  out += "\n# T_B_C: the camera on the cart (x forward, y left, z up)\n[mounting]\n";
  out += "translation_m = " + list_of(calibration.T_B_C.t) + "\n";
  out += "quaternion_wxyz = " + list_of({q.w(), q.x(), q.y(), q.z()}) + "\n";
  out += "camera_sigma_m = " + text_of(calibration.camera_sigma_m) + "\n";
  out += "camera_rotation_sigma_rad = " + text_of(calibration.camera_rotation_sigma_rad) + "\n";
  for (const AntennaCalibration& a : calibration.antennas) {
    out += "\n[[antenna]]\nport = " + std::to_string(a.port) + "\n";
    out += "p_C_A_m = " + list_of(a.p_C_A_m) + "\n";
    out += "boresight_C = " + list_of(a.boresight_C) + "\n";
    out += "lever_arm_sigma_m = " + list_of(a.lever_arm_sigma_m) + "\n";
    out += "electrical_length_m = " + text_of(a.electrical_length_m) + "\n";
    out += "electrical_length_sigma_m = " + text_of(a.electrical_length_sigma_m) + "\n";
  }
  return out;
}

}  // namespace rfmvo
