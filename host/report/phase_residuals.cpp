#include <algorithm>
#include <cmath>
#include <complex>

#include "base/units.hpp"
#include "report/journal_data.hpp"

namespace rfmvo::report {
namespace {

constexpr double kHzPerMHz = 1e6;
// Of the phase over frequency: cables up to 24 m, there and back, at two thirds of the speed of light.
constexpr double kMaxSlope_rad_per_MHz = 1.5, kSlopeStep_rad_per_MHz = 0.01;

std::optional<Rigid3> pose_at(const evaluate::LastEstimates& last, DeviceTime time) {
  for (const auto& [segment, trajectory] : last.trajectories) {
    const auto& poses = trajectory.poses;
    const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                        [](const MetricPose& pose, DeviceTime t) { return pose.time < t; });
    if (after == poses.end() || (after == poses.begin() && after->time != time)) continue;
    if (after->time == time) return after->T_W_C;
    const MetricPose& before = *(after - 1);
    const double f = (time - before.time).seconds() / (after->time - before.time).seconds();
    return interpolate(before.T_W_C, after->T_W_C, f);
  }
  return std::nullopt;
}

// What is left when the distance is taken off; nothing where it is not known.
std::optional<double> less_distance(const TagRead& read, const Calibration& calibration,
                                    const evaluate::LastEstimates& last) {
  const auto tag = last.tags.find(read.epc);
  const auto antenna = std::find_if(calibration.antennas.begin(), calibration.antennas.end(),
                                    [&](const AntennaCalibration& a) { return a.port == read.port; });
  if (tag == last.tags.end() || !evaluate::is_located(tag->second) || antenna == calibration.antennas.end())
    return std::nullopt;
  const auto T_W_C = pose_at(last, read.time);
  if (!T_W_C) return std::nullopt;
  const double distance_m = (*T_W_C * antenna->p_C_A_m - tag->second.p_W_X_m).norm();
  return wrap_rad(read.phase.rad() - 4.0 * kPi * read.frequency_hz * distance_m / kSpeedOfLight_m_s);
}

struct Part {
  std::size_t index = 0;
  double phase_rad = 0.0, frequency_MHz = 0.0;  // less that of the port's first read
};
using PartsOfTag = std::map<Epc, std::vector<Part>>;

std::complex<double> sum_of(const std::vector<Part>& parts, double slope) {
  std::complex<double> sum = 0.0;
  for (const Part& part : parts) sum += std::polar(1.0, part.phase_rad - slope * part.frequency_MHz);
  return sum;
}

// The slope at which the tags' phases agree best, each with itself.
double slope_of(const PartsOfTag& tags) {
  double best = 0.0, best_sum = -1.0;
  for (double slope = -kMaxSlope_rad_per_MHz; slope <= kMaxSlope_rad_per_MHz; slope += kSlopeStep_rad_per_MHz) {
    double sum = 0.0;
    for (const auto& [epc, parts] : tags) sum += std::abs(sum_of(parts, slope));
    if (sum > best_sum) best_sum = sum, best = slope;
  }
  return best;
}

}  // namespace

void add_residuals(const std::vector<TagRead>& reads, const Calibration& calibration,
                   const evaluate::LastEstimates& last, std::vector<ReadPoint>& points) {
  RFMVO_ASSERT(reads.size() == points.size());
  std::map<std::uint8_t, PartsOfTag> ports;
  std::map<std::uint8_t, double> first_MHz;
  for (std::size_t i = 0; i < reads.size(); ++i) {
    const auto phase = less_distance(reads[i], calibration, last);
    if (!phase) continue;
    const double f_MHz = reads[i].frequency_hz / kHzPerMHz;
    const double base_MHz = first_MHz.emplace(reads[i].port, f_MHz).first->second;
    ports[reads[i].port][reads[i].epc].push_back({i, *phase, f_MHz - base_MHz});
  }
  for (const auto& [port, tags] : ports) {
    const double slope = slope_of(tags);
    for (const auto& [epc, parts] : tags) {
      const double mean = std::arg(sum_of(parts, slope));
      for (const Part& part : parts)
        points[part.index].residual_rad = wrap_rad(part.phase_rad - slope * part.frequency_MHz - mean);
    }
  }
}

}  // namespace rfmvo::report
