#include "inspect/result_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "config/config_table.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"

namespace rfmvo::inspect {
namespace {

// One of the two files while it is read.
class Side {
 public:
  static Result<Side> open(const std::string& path, const std::string& prefix) {
    auto file = LogFileReader::open(path);
    if (!file) return file.error();
    Side side;
    side.file_ = std::move(file).value();
    side.prefix_ = prefix;
    return side;
  }
  // The next record is looked into as far as the comparison needs it. False: the end.
  Result<bool> advance() {
    auto read = file_->next();
    if (!read) return read.error();
    record = std::move(read).value();
    if (!record) return false;
    ++records;
    const auto in_record = [this](const Error& error) {
      return Error{error.code, error.text(), file_->where(record->offset)};
    };
    if (is_estimate_channel(record->channel, prefix_)) {
      auto estimate = decode_estimate(record->channel, record->data, prefix_);
      if (!estimate) return in_record(estimate.error());
      estimates.push_back(std::move(estimate).value());
    } else if (!start && record->channel == prefix_ + "START") {
      auto event = decode_event(record->channel, record->data, prefix_);
      if (!event) return in_record(event.error());
      start = std::get<Start>(std::move(event).value());
    }
    return true;
  }
  [[nodiscard]] std::string place() const {
    if (!record) return "the end";
    return fmt::format("{} of {}.{:06} s", record->channel, record->utime / 1'000'000, record->utime % 1'000'000);
  }

  std::optional<LogRecord> record;
  std::uint64_t records = 0;
  std::vector<Estimate> estimates;
  std::optional<Start> start;

 private:
  std::unique_ptr<LogFileReader> file_;
  std::string prefix_;
};

bool same_record(const std::optional<LogRecord>& a, const std::optional<LogRecord>& b) {
  if (!a || !b) return !a && !b;
  return a->channel == b->channel && a->utime == b->utime && a->data == b->data;
}

std::vector<SettingDifference> compare_settings(const Side& a, const Side& b) {
  std::vector<SettingDifference> differences;
  if (!a.start || !b.start) return differences;
  for (const ConfigRow& row : config_rows()) {
    const ConfigValue of_a = get_value(a.start->config, row), of_b = get_value(b.start->config, row);
    const auto text = [](const ConfigValue& value) {
      return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
    };
    if (of_a != of_b) differences.push_back({std::string(row.key), text(of_a), text(of_b)});
  }
  return differences;
}

template <class Map>
auto find_in(const Map& map, const typename Map::key_type& key) -> std::optional<typename Map::mapped_type> {
  const auto found = map.find(key);
  return found == map.end() ? std::nullopt : std::optional(found->second);
}

template <class Map>
std::set<typename Map::key_type> keys_of(const Map& a, const Map& b) {
  std::set<typename Map::key_type> keys;
  for (const auto& [key, value] : a) keys.insert(key);
  for (const auto& [key, value] : b) keys.insert(key);
  return keys;
}

std::vector<TagDifference> compare_tags(const evaluate::LastEstimates& a, const evaluate::LastEstimates& b) {
  std::vector<TagDifference> differences;
  for (const Epc& epc : keys_of(a.tags, b.tags)) {
    TagDifference d{epc, find_in(a.tags, epc), find_in(b.tags, epc), std::nullopt};
    if (d.a && d.b && evaluate::is_located(*d.a) && evaluate::is_located(*d.b))
      d.distance_m = (d.a->p_W_X_m - d.b->p_W_X_m).norm();
    differences.push_back(std::move(d));
  }
  return differences;
}

std::vector<ScaleDifference> compare_scales(const evaluate::LastEstimates& a, const evaluate::LastEstimates& b) {
  std::vector<ScaleDifference> differences;
  for (const std::uint32_t segment : keys_of(a.scales, b.scales)) {
    ScaleDifference d{segment, find_in(a.scales, segment), find_in(b.scales, segment), std::nullopt};
    if (d.a && d.b && d.a->observable && d.b->observable) d.relative = d.b->m_per_unit / d.a->m_per_unit - 1.0;
    differences.push_back(d);
  }
  return differences;
}

PathDifference compare_path(std::uint32_t segment, const std::vector<MetricPose>& a, const std::vector<MetricPose>& b) {
  PathDifference d{segment, a.size(), b.size(), 0, 0.0, 0.0, {}};
  double squares = 0.0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].time != b[j].time) {
      ++(a[i].time < b[j].time ? i : j);
      continue;
    }
    const double distance = (a[i].T_W_C.t - b[j].T_W_C.t).norm();
    squares += distance * distance;
    if (distance > d.max_m) {
      d.max_m = distance;
      d.max_at = a[i].time;
    }
    ++d.compared, ++i, ++j;
  }
  if (d.compared > 0) d.rms_m = std::sqrt(squares / static_cast<double>(d.compared));
  return d;
}

std::vector<PathDifference> compare_paths(const evaluate::LastEstimates& a, const evaluate::LastEstimates& b) {
  std::vector<PathDifference> differences;
  const auto poses = [](const evaluate::LastEstimates& last, std::uint32_t segment) {
    const auto found = last.trajectories.find(segment);
    return found == last.trajectories.end() ? std::vector<MetricPose>() : found->second.poses;
  };
  for (const std::uint32_t segment : keys_of(a.trajectories, b.trajectories))
    differences.push_back(compare_path(segment, poses(a, segment), poses(b, segment)));
  return differences;
}

}  // namespace

bool TagDifference::within(double tolerance_m) const {
  if (!a || !b || a->status != b->status) return false;
  return evaluate::is_located(*a) == evaluate::is_located(*b) && distance_m.value_or(0.0) <= tolerance_m;
}

bool ScaleDifference::within(double tolerance) const {
  return a && b && a->observable == b->observable && std::abs(relative.value_or(0.0)) <= tolerance;
}

bool PathDifference::within(double tolerance_m) const {
  return poses_a == poses_b && compared == poses_a && max_m <= tolerance_m;
}

bool ResultDiff::same(const Tolerance& tolerance) const {
  if (tolerance.none() || !first) return !first;
  const auto all = [](const auto& differences, double limit) {
    return std::all_of(differences.begin(), differences.end(), [limit](const auto& d) { return d.within(limit); });
  };
  return all(tags, tolerance.position_m) && all(scales, tolerance.scale) && all(paths, tolerance.position_m);
}

Result<ResultDiff> diff_results(const std::string& path_a, const std::string& path_b, const std::string& prefix) {
  auto opened_a = Side::open(path_a, prefix);
  if (!opened_a) return opened_a.error();
  auto opened_b = Side::open(path_b, prefix);
  if (!opened_b) return opened_b.error();
  Side a = std::move(opened_a).value(), b = std::move(opened_b).value();
  ResultDiff diff;
  for (std::uint64_t index = 0;; ++index) {
    const auto more_a = a.advance(), more_b = b.advance();
    if (!more_a) return more_a.error();
    if (!more_b) return more_b.error();
    if (!diff.first && !same_record(a.record, b.record)) diff.first = FirstDifference{index, a.place(), b.place()};
    if (!more_a.value() && !more_b.value()) break;
  }
  diff.records_a = a.records;
  diff.records_b = b.records;
  diff.settings = compare_settings(a, b);
  const evaluate::LastEstimates last_a = evaluate::last_of(a.estimates), last_b = evaluate::last_of(b.estimates);
  diff.tags = compare_tags(last_a, last_b);
  diff.scales = compare_scales(last_a, last_b);
  diff.paths = compare_paths(last_a, last_b);
  return diff;
}

}  // namespace rfmvo::inspect
