#include "reproduce/run_times.hpp"

#include <cmath>

#include "base/units.hpp"
#include "estimator/accuracy_estimation.hpp"
#include "estimator/joint_optimization.hpp"
#include "estimator/spatial_power_spectrum.hpp"
#include "montecarlo/cpu_time.hpp"
#include "reproduce/first_arrays.hpp"

namespace rfmvo::reproduce {
namespace {

constexpr double kTimedFor_s = 0.1;                                   // each stage is repeated this long
constexpr double kScaleMin = 0.5, kScaleMax = 2.0, kScaleStep = 0.1;  // of the true scale

template <class Work>
double seconds_of(const Work& work) {
  const double start_s = montecarlo::thread_cpu_s();
  double spent_s = 0.0;
  int repeats = 0;
  while (spent_s < kTimedFor_s) {
    work();
    ++repeats;
    spent_s = montecarlo::thread_cpu_s() - start_s;
  }
  return spent_s / repeats;
}

void time_paper(const std::vector<AntennaArray>& arrays, double scale, const Config& config,
                std::vector<RunTime>& times) {
  const ScaleRange range{kScaleMin * scale, kScaleMax * scale};
  const double step_rad = rad_from_deg(config.paper.angle_step_deg);
  // search_spectrum takes the step in units of the range's middle.
  const double step = kScaleStep / (0.5 * (kScaleMin + kScaleMax));
  SpectrumPeak peak = search_spectrum(arrays, range, step_rad, step);
  times.push_back({"spectrum search, section III.A: one array, 5 degrees, gamma 0.5 to 2.0 by 0.1", "0.52 s",
                   seconds_of([&] { peak = search_spectrum(arrays, range, step_rad, step); })});
  times.push_back({"the same, gamma by 0.05", "14.24 s",
                   seconds_of([&] { peak = search_spectrum(arrays, range, step_rad, 0.5 * step); })});
  if (!peak.found) return;
  const std::vector<AntennaTerm> terms = terms_of(arrays, peak);
  JointOptions options;
  options.refine_step_rad = rad_from_deg(config.paper.refine_step_deg);
  options.refine_range_rad = rad_from_deg(config.paper.refine_range_deg);
  options.max_iterations = static_cast<int>(config.paper.max_iterations);
  ArraySolution solution;
  times.push_back({"joint optimization, section IV: one array, until it converges", "16 ms",
                   seconds_of([&] { solution = joint_optimization(terms, peak.gamma, options); })});
  std::vector<Eigen::Vector3d> positions;
  for (const AntennaArray& array : arrays)
    for (Eigen::Index i = 0; i < array.elements(); ++i) positions.push_back(array.position_m(i, scale));
  const Eigen::Vector3d p_X = positions.front() + Eigen::Vector3d(0.5, 0.3, 1.6);
  Hdop hdop;
  times.push_back({"accuracy estimation, section V: one array", "",
                   seconds_of([&] { hdop = horizontal_dilution(positions, p_X); })});
}

}  // namespace

std::vector<RunTime> time_stages(const montecarlo::Recording& recording, const Config& paper, const Study& study) {
  std::vector<RunTime> times;
  const double before_s = montecarlo::thread_cpu_s();
  const std::vector<SampledRead> reads = synchronized_reads(recording, paper);
  const double synchronization_s = montecarlo::thread_cpu_s() - before_s;
  if (!reads.empty())
    times.push_back({"sampling synchronization: one read", "", synchronization_s / static_cast<double>(reads.size())});
  const std::vector<AntennaArray> arrays =
      first_arrays(reads, std::get<Start>(recording.events.front()).calibration, paper.paper.elements);
  if (!arrays.empty()) time_paper(arrays, recording.truth.scale_m_per_unit, paper, times);
  double joint_s = 0.0, joint_reads = 0.0, span_s = 0.0, tagoram_s = 0.0, mobitagbot_s = 0.0, tags = 0.0;
  for (const Run& run : study.runs) {
    joint_s += run.joint_cpu_s;
    span_s += run.span_s;
    joint_reads += static_cast<double>(run.reads);
    tagoram_s += run.tagoram_cpu_s;
    mobitagbot_s += run.mobitagbot_cpu_s;
    tags += static_cast<double>(run.tagoram.size());
  }
  if (joint_reads > 0.0) times.push_back({"joint estimator: one read, all of its work", "", joint_s / joint_reads});
  if (span_s > 0.0) times.push_back({"joint estimator: one second of a run", "", joint_s / span_s});
  if (!(tags > 0.0)) return times;
  times.push_back({"Tagoram: one tag, 60 x 60 x 25 cells", "", tagoram_s / tags});
  times.push_back({"MobiTagbot: one tag, the same region", "", mobitagbot_s / tags});
  return times;
}

}  // namespace rfmvo::reproduce
