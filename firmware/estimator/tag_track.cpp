#include "estimator/tag_track.hpp"

#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo {
namespace {

// Largest angle at the tag between its direction from the first antenna position and from any other.
double sweep_rad(const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& p_X) {
  double smallest_cos = 1.0;
  const Eigen::Vector3d reference = (p_X - positions.front()).normalized();
  for (const Eigen::Vector3d& p : positions)
    smallest_cos = std::min(smallest_cos, reference.dot((p_X - p).normalized()));
  return std::acos(std::clamp(smallest_cos, -1.0, 1.0));
}

// All elements, axes of W, origin the camera at the first read.
std::vector<Eigen::Vector3d> positions_of(const std::vector<AntennaTerm>& terms, double gamma,
                                          const Eigen::Quaterniond& R_W_V) {
  std::vector<Eigen::Vector3d> positions;
  for (const AntennaTerm& term : terms)
    for (Eigen::Index i = 0; i < term.array.elements(); ++i)
      positions.push_back(R_W_V * term.array.position_m(i, gamma));
  return positions;
}

// Section III.B.
SearchedPosition locate(const std::vector<AntennaTerm>& terms, double gamma, bool fix_sphere_average,
                        const Eigen::Quaterniond& R_W_V) {
  std::vector<IncidentAngles> angles;
  for (const AntennaTerm& term : terms) angles.push_back(term.angles);
  const LineIntersection point = intersect_lines(terms, angles, gamma, fix_sphere_average);
  SearchedPosition searched{point.determined && point.point.norm() < kMaxTagRange_m, point.point, gamma, {}};
  if (searched.found) searched.hdop = horizontal_dilution(positions_of(terms, gamma, R_W_V), R_W_V * point.point);
  return searched;
}

}  // namespace

TagTrack::TagTrack(const PaperConfig& config, const std::vector<AntennaCalibration>& antennas)
    : config_(config),
      antennas_(&antennas),
      by_antenna_(antennas.size()),
      elements_(static_cast<std::uint64_t>(std::max<std::int64_t>(config.elements, 2))) {
  array_options_.fix_rotation = config.fix_rotation;
  array_options_.turning_frame = config.fix_rotation && config.fix_sphere_average;
}

const SampledRead* TagTrack::newest(std::size_t antenna) const {
  const AntennaReads& port = by_antenna_[antenna];
  return port.reads.empty() ? nullptr : &port.reads.back();
}

void TagTrack::on(std::size_t antenna, const SampledRead& read, const PhaseCalibration& phases) {
  by_antenna_[antenna].reads.push_back(read);
  last_read_ = read.read.time;
  ++reads_;
  ++reads_since_array_;
  const auto active = static_cast<std::int64_t>(std::count_if(
      by_antenna_.begin(), by_antenna_.end(), [this](const AntennaReads& a) { return a.reads.size() >= elements_; }));
  enough_reads_ = enough_reads_ || active > 0;
  // One step of the arrays is one read on EACH of the M antennas.
  if (active > 0 && reads_since_array_ >= active * std::max<std::int64_t>(config_.array_stride, 1)) search(phases);
  forget();
}

// The antennas with L reads whose reads overlap in time with the newest one's.
std::vector<TagTrack::Member> TagTrack::due_members() const {
  DeviceTime begin{};
  for (const AntennaReads& port : by_antenna_)
    if (port.reads.size() >= elements_ && port.reads.back().read.time == last_read_)
      begin = port.reads[port.reads.size() - elements_].read.time;
  std::vector<Member> members;
  for (std::size_t a = 0; a < by_antenna_.size(); ++a) {
    const AntennaReads& port = by_antenna_[a];
    if (port.reads.size() < elements_ || port.reads.back().read.time < begin) continue;
    Member& member = members.emplace_back();
    member.antenna = a;
    member.first = port.first + port.reads.size() - elements_;
  }
  return members;
}

void TagTrack::search(const PhaseCalibration& phases) {
  reads_since_array_ = 0;
  Record record;
  record.members = due_members();
  std::vector<AntennaArray> arrays;
  for (Member& member : record.members) {
    const AntennaReads& port = by_antenna_[member.antenna];
    arrays.push_back(array_of(member, port.reads[member.first - port.first].T_V_C.p_V_C, phases));
    member.R_V_D = arrays.back().R_V_D;
  }
  const ScaleRange range =
      scale_range(arrays, {config_.max_speed_m_s, config_.min_read_rate_hz, config_.fix_scale_range});
  const SpectrumPeak peak = search_spectrum(arrays, range, rad_from_deg(config_.angle_step_deg), config_.scale_step);
  ++arrays_due_;
  if (!peak.found) {
    ++arrays_without_range_;
    return;
  }
  for (std::size_t j = 0; j < record.members.size(); ++j)
    record.members[j].angles = record.members[j].searched = peak.angles[j];
  record.range = range;
  record.gamma = peak.gamma;
  records_.push_back(std::move(record));
}

AntennaArray TagTrack::array_of(const Member& member, const Eigen::Vector3d& p_V_origin,
                                const PhaseCalibration& phases) const {
  const AntennaReads& port = by_antenna_[member.antenna];
  return make_array(port.reads, member.first - port.first, elements_, p_V_origin, (*antennas_)[member.antenna], phases,
                    array_options_);
}

// No later array shares an element: 2 L - 1 reads from its first on. An antenna that lost the tag must not
// hold up the array for ever.
bool TagTrack::complete(const Record& record) const {
  const auto read_since = [this](const Member& m) {
    const AntennaReads& port = by_antenna_[m.antenna];
    return port.first + port.reads.size() - m.first;
  };
  const auto& all = record.members;
  return std::all_of(all.begin(), all.end(), [&](const Member& m) { return read_since(m) >= 2 * elements_ - 1; }) ||
         std::any_of(all.begin(), all.end(), [&](const Member& m) { return read_since(m) >= 3 * elements_; });
}

// Eq. (9), (10): element n of an antenna belongs to the arrays with first <= n < first + L.
std::vector<AngleSums> TagTrack::others(const Record& record, const Member& member,
                                        IncidentAngles Member::*angles) const {
  std::vector<AngleSums> sums(elements_);
  for (const Record& other : records_) {
    if (&other == &record) continue;
    for (const Member& m : other.members) {
      if (m.antenna != member.antenna) continue;
      const std::uint64_t begin = std::max(m.first, member.first);
      const std::uint64_t end = std::min(m.first, member.first) + elements_;
      for (std::uint64_t n = begin; n < end; ++n) sums[n - member.first].add(m.*angles, m.R_V_D);
    }
  }
  return sums;
}

const SampledRead& TagTrack::first_read(const Record& record) const {
  const SampledRead* first = nullptr;
  for (const Member& m : record.members) {
    const AntennaReads& port = by_antenna_[m.antenna];
    const SampledRead& read = port.reads[m.first - port.first];
    if (first == nullptr || read.read.time < first->read.time) first = &read;
  }
  RFMVO_ASSERT(first != nullptr);
  return *first;
}

std::optional<SolvedArray> TagTrack::solve_next(bool all, const PhaseCalibration& phases,
                                                const Eigen::Quaterniond& R_W_V) {
  const auto next = std::find_if(records_.begin(), records_.end(), [](const Record& r) { return !r.solved; });
  if (next == records_.end() || !(all || complete(*next))) return std::nullopt;
  SolvedArray solved = solve(*next, phases, R_W_V);
  forget();
  return solved;
}

std::vector<AntennaTerm> TagTrack::terms_of(const Record& record, IncidentAngles Member::*angles,
                                            const PhaseCalibration& phases) const {
  const Eigen::Vector3d p_V_origin = first_read(record).T_V_C.p_V_C;
  std::vector<AntennaTerm> terms;
  for (const Member& m : record.members)
    terms.push_back({array_of(m, p_V_origin, phases), m.*angles, others(record, m, angles)});
  return terms;
}

SolvedArray TagTrack::solve(Record& record, const PhaseCalibration& phases, const Eigen::Quaterniond& R_W_V) {
  const SampledRead& first = first_read(record);
  SolvedArray out;
  out.first = out.last = first.read.time;
  out.R_V_C = first.T_V_C.R_V_C;
  out.range = record.range;
  for (const Member& m : record.members) {
    const AntennaReads& port = by_antenna_[m.antenna];
    out.last = std::max(out.last, port.reads[m.first - port.first + elements_ - 1].read.time);
  }
  out.searched = locate(terms_of(record, &Member::searched, phases), record.gamma, config_.fix_sphere_average, R_W_V);
  const std::vector<AntennaTerm> terms = terms_of(record, &Member::angles, phases);
  JointOptions options;
  options.refine_step_rad = rad_from_deg(config_.refine_step_deg);
  options.refine_range_rad = rad_from_deg(config_.refine_range_deg);
  options.max_iterations = static_cast<int>(std::max<std::int64_t>(config_.max_iterations, 1));
  options.fix_sphere_average = config_.fix_sphere_average;
  options.fix_cycles = config_.fix_cycles;
  out.solution = joint_optimization(terms, record.gamma, options);
  record.solved = true;
  // Differs from Eq. (18): its minimisation is free of the limits (4), (5). It can run off to a scale that
  // they exclude, and a long array has a small HDOP, so that it would be selected.
  if (config_.fix_scale_range && (out.solution.gamma < record.range.min || out.solution.gamma > record.range.max))
    out.solution.found = false;
  if (!out.solution.found) return out;

  for (std::size_t j = 0; j < terms.size(); ++j) record.members[j].angles = out.solution.angles[j];
  const std::vector<Eigen::Vector3d> positions = positions_of(terms, out.solution.gamma, R_W_V);
  const Eigen::Vector3d p_X = R_W_V * out.solution.p_X_m;
  out.hdop = horizontal_dilution(positions, p_X);
  out.bearing_sweep_rad = sweep_rad(positions, p_X);
  out.reads = static_cast<std::uint32_t>(positions.size());
  return out;
}

void TagTrack::begin_segment() {
  for (AntennaReads& port : by_antenna_) port = {};
  records_.clear();
  reads_since_array_ = 0;
}

// True while an unsolved array, or one still to come, shares an element with this one.
bool TagTrack::shared(const Record& record) const {
  for (const Member& m : record.members) {
    const AntennaReads& port = by_antenna_[m.antenna];
    if (m.first + 2 * elements_ > port.first + port.reads.size() + 1) return true;
    for (const Record& other : records_)
      for (const Member& o : other.members)
        if (!other.solved && o.antenna == m.antenna && o.first < m.first + elements_ && m.first < o.first + elements_)
          return true;
  }
  return false;
}

// Drops solved arrays and reads that nothing needs any more.
void TagTrack::forget() {
  while (!records_.empty() && records_.front().solved && !shared(records_.front())) records_.pop_front();
  for (std::size_t a = 0; a < by_antenna_.size(); ++a) {
    AntennaReads& port = by_antenna_[a];
    std::uint64_t needed = port.first + port.reads.size() - std::min<std::uint64_t>(port.reads.size(), elements_);
    for (const Record& r : records_)
      for (const Member& m : r.members)
        if (m.antenna == a && !r.solved) needed = std::min(needed, m.first);
    for (; port.first < needed; ++port.first) port.reads.pop_front();
  }
}

}  // namespace rfmvo
