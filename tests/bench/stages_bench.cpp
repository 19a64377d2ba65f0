// One update of each stage, on reads of the simulated wall; where it makes sense beside the same in double without the
// kernel, in the same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "base/units.hpp"
#include "estimator/accuracy_estimation.hpp"
#include "estimator/array_spectrum.hpp"
#include "estimator/pipeline.hpp"
#include "estimator/trajectory_recovery.hpp"
#include "reproduce/first_arrays.hpp"

namespace rfmvo {
namespace {

const montecarlo::Recording& wall() {
  static const montecarlo::Recording recording = [] {
    simulate::Options options;
    options.scene = "wall";
    return montecarlo::record(options, nullptr).value();
  }();
  return recording;
}

const Start& start() { return std::get<Start>(wall().events.front()); }

// L = 60, M = 2.
const std::vector<AntennaArray>& arrays() {
  static const std::vector<AntennaArray> result = reproduce::first_arrays(
      reproduce::synchronized_reads(wall(), start().config), start().calibration, start().config.paper.elements);
  return result;
}

double scale() { return wall().truth.scale_m_per_unit; }

void sampling_synchronization(benchmark::State& state) {
  const montecarlo::Recording& recording = wall();  // made outside of the loop
  std::size_t reads = 0;
  for (auto _ : state) reads += reproduce::synchronized_reads(recording, start().config).size();
  state.SetItemsProcessed(static_cast<std::int64_t>(reads));  // reads; their poses come along
}
BENCHMARK(sampling_synchronization)->Unit(benchmark::kMillisecond);

// The paper's grid: 5 degrees, gamma 0.5 to 2.0 by 0.1; it takes 0.52 s there.
const GammaSteps kGammas{0.5, 0.1, 16};

GammaSteps gammas() { return {kGammas.first * scale(), kGammas.step * scale(), kGammas.count}; }

DirectionGrid five_degrees() {
  std::vector<double> angles;
  for (int n = 0; n <= 36; ++n) angles.push_back(rad_from_deg(5.0 * n));
  return {angles, angles};
}

template <std::vector<GridPeak> (ArraySpectrum::*kPeaks)(const DirectionGrid&, const GammaSteps&)>
void spectrum_search(benchmark::State& state) {
  for (auto _ : state)
    for (const AntennaArray& array : arrays()) {
      ArraySpectrum spectrum(array);
      benchmark::DoNotOptimize((spectrum.*kPeaks)(five_degrees(), gammas()));
    }
}
BENCHMARK(spectrum_search<&ArraySpectrum::peaks>)->Name("spectrum_search")->Unit(benchmark::kMillisecond);
BENCHMARK(spectrum_search<&ArraySpectrum::peaks_in_double>)
    ->Name("spectrum_search_in_double")
    ->Unit(benchmark::kMillisecond);

SpectrumPeak first_peak() {
  const GammaSteps g = gammas();
  const ScaleRange range{g.first, g.at(g.count - 1)};
  return search_spectrum(arrays(), range, rad_from_deg(5.0), g.step / (0.5 * (range.min + range.max)));
}

// Section IV, until it converges; 16 ms in the paper.
void joint_optimization_loop(benchmark::State& state) {
  const SpectrumPeak peak = first_peak();
  const std::vector<AntennaTerm> terms = reproduce::terms_of(arrays(), peak);
  JointOptions options;
  options.refine_step_rad = rad_from_deg(start().config.paper.refine_step_deg);
  options.refine_range_rad = rad_from_deg(start().config.paper.refine_range_deg);
  options.max_iterations = static_cast<int>(state.range(0));
  ArraySolution solution;
  for (auto _ : state) {
    solution = joint_optimization(terms, peak.gamma, options);
    benchmark::DoNotOptimize(solution);
  }
  state.counters["iterations"] = solution.iterations;
  state.counters["converged"] = solution.converged ? 1.0 : 0.0;
}
BENCHMARK(joint_optimization_loop)->ArgName("at_most")->Arg(4)->Arg(10)->Unit(benchmark::kMillisecond);

// Eq. (16) of one antenna: 41 x 41 directions.
template <std::vector<GridPeak> (ArraySpectrum::*kPeaks)(const DirectionGrid&, const GammaSteps&)>
void angle_refinement(benchmark::State& state) {
  std::vector<double> window;
  for (int n = -20; n <= 20; ++n) window.push_back(rad_from_deg(70.0 + n));
  const DirectionGrid grid(window, window);
  ArraySpectrum spectrum(arrays()[0]);
  for (auto _ : state) benchmark::DoNotOptimize((spectrum.*kPeaks)(grid, {scale(), 0.0, 1}));
}
BENCHMARK(angle_refinement<&ArraySpectrum::peaks>)->Name("angle_refinement")->Unit(benchmark::kMicrosecond);
BENCHMARK(angle_refinement<&ArraySpectrum::peaks_in_double>)
    ->Name("angle_refinement_in_double")
    ->Unit(benchmark::kMicrosecond);

void accuracy_estimation(benchmark::State& state) {
  std::vector<Eigen::Vector3d> positions;
  for (const AntennaArray& array : arrays())
    for (Eigen::Index i = 0; i < array.elements(); ++i) positions.push_back(array.position_m(i, scale()));
  const Eigen::Vector3d p_X = positions.front() + Eigen::Vector3d(0.5, 0.3, 1.6);
  for (auto _ : state) benchmark::DoNotOptimize(horizontal_dilution(positions, p_X));
}
BENCHMARK(accuracy_estimation)->Unit(benchmark::kMicrosecond);

// A candidate that spans 12 s of 15, and the whole path after it.
void trajectory_recovery(benchmark::State& state) {
  TrajectoryRecovery recovery(start().calibration.T_B_C);
  for (const Event& event : wall().events)
    if (const auto* pose = std::get_if<CameraPose>(&event)) recovery.on(*pose);
  const DeviceTime begin = start().time, end{begin.ns + 12'000'000'000};
  double hdop = 1e6;
  for (auto _ : state) {
    recovery.on(ScaleCandidate{begin, end, scale(), 0.01, hdop});
    hdop *= 0.999999;  // better than the one before: it takes the steps over
    benchmark::DoNotOptimize(recovery.path());
  }
}
BENCHMARK(trajectory_recovery)->Unit(benchmark::kMicrosecond);

// The joint estimator over a whole run: what a read costs on average, and the longest events, which solve again (a read
// is used once the camera pose after it is there; so most of the work is in poses).
void joint_estimator(benchmark::State& state) {
  const montecarlo::Recording& recording = wall();
  Config config = start().config;
  config.estimator.kind = "joint";
  config.estimator.pose_source = "poses";
  std::vector<double> event_s;
  std::size_t reads = 0;
  for (auto _ : state) {
    Pipeline pipeline;
    event_s.clear();
    reads = 0;
    for (const Event& event : recording.events) {
      const auto before = std::chrono::steady_clock::now();
      if (const auto* begin = std::get_if<Start>(&event))
        benchmark::DoNotOptimize(pipeline.on(Start{begin->time, config, begin->calibration}));
      else
        benchmark::DoNotOptimize(pipeline.on(event));
      event_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
      if (std::holds_alternative<TagRead>(event)) ++reads;
    }
  }
  std::sort(event_s.begin(), event_s.end());
  const double all_s = std::accumulate(event_s.begin(), event_s.end(), 0.0);
  const auto rank = [&](double share) {
    return event_s[static_cast<std::size_t>(share * static_cast<double>(event_s.size() - 1))];
  };
  state.counters["per_read_s"] = all_s / static_cast<double>(reads);
  state.counters["event_median_s"] = rank(0.5);
  state.counters["event_p99_s"] = rank(0.99);
  state.counters["resolve_max_s"] = event_s.back();
}
BENCHMARK(joint_estimator)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace rfmvo
