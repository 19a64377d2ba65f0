// The fixed-point kernels beside the same sums in double with std::cos, and beside the float block that the
// spherical kernel replaced. Items are cells times terms.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cmath>

#include "bench/float_spectrum_block.hpp"
#include "kernels/plane_wave_search.hpp"
#include "kernels/scenes.hpp"
#include "kernels/spectrum_reference.hpp"
#include "kernels/spherical_wave_spectrum.hpp"

namespace rfmvo {
namespace {

using testing::Motion;
using testing::Random;

// The paper's: L = 60, 5 degrees, gamma 0.5 to 2.0 by 0.1, M = 2.
constexpr ScaleSteps kScales{.first = 0.5F, .step = 0.1F, .count = 16};
constexpr int kSteps = 59, kAngles = 37;

std::vector<PlaneWaveSteps> paper_antennas() {
  Random random(1);
  std::vector<PlaneWaveSteps> antennas;
  for (int m = 0; m < 2; ++m) antennas.push_back(testing::plane_wave_steps(random, kSteps, Motion::kTurning, 0.3));
  return antennas;
}

void count_terms(benchmark::State& state, double terms) {
  state.counters["terms"] =
      benchmark::Counter(terms * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void plane_wave_double_std_cos(benchmark::State& state) {
  const auto antennas = paper_antennas();
  std::vector<reference::PlaneStep> steps;
  for (const PlaneWaveStep& s : antennas[0])
    steps.push_back(
        {{s.camera_turns[0], s.camera_turns[1], s.camera_turns[2]}, reference::kTwoPi * s.phase_step_q16 / 65536.0});
  const AngleGrid grid(kAngles);
  const Directions u = grid.directions();
  for (auto _ : state)
    for (std::size_t d = 0; d < grid.size(); ++d)
      for (int n = 0; n < kScales.count; ++n)
        benchmark::DoNotOptimize(
            reference::spatial_power_along(steps, {u.x[d], u.y[d], u.z[d]}, reference::kTwoPi * kScales.at(n)));
  count_terms(state, static_cast<double>(grid.size()) * kScales.count * kSteps);
}
BENCHMARK(plane_wave_double_std_cos)->Unit(benchmark::kMillisecond);

// Argument: a Highway target, 0 for the best of this machine.
void plane_wave_kernel(benchmark::State& state) {
  hwy::SetSupportedTargetsForTest(state.range(0));
  const PlaneWaveSpectrum spectrum(paper_antennas()[0], kScales);
  const AngleGrid grid(kAngles);
  std::vector<std::int32_t> sums(grid.size() * static_cast<std::size_t>(kScales.count));
  for (auto _ : state) {
    spectrum.evaluate(grid.directions(), 0, kScales.count, sums);
    benchmark::DoNotOptimize(sums.data());
  }
  count_terms(state, static_cast<double>(sums.size()) * kSteps);
  hwy::SetSupportedTargetsForTest(0);
}
void each_target(benchmark::internal::Benchmark* b) {
  const std::int64_t targets = hwy::SupportedTargets();
  b->Arg(0);
  for (const std::int64_t target : {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_SSSE3})
    if ((targets & target) != 0) b->Arg(target);
}
BENCHMARK(plane_wave_kernel)->Apply(each_target)->ArgName("hwy_target")->Unit(benchmark::kMillisecond);

void plane_wave_scalar_definition(benchmark::State& state) {
  const PlaneWaveSpectrum spectrum(paper_antennas()[0], kScales);
  const AngleGrid grid(kAngles);
  std::vector<std::int32_t> sums(grid.size() * static_cast<std::size_t>(kScales.count));
  for (auto _ : state) {
    spectrum.evaluate_scalar(grid.directions(), 0, kScales.count, sums);
    benchmark::DoNotOptimize(sums.data());
  }
  count_terms(state, static_cast<double>(sums.size()) * kSteps);
}
BENCHMARK(plane_wave_scalar_definition)->Unit(benchmark::kMillisecond);

template <SpectrumMaximum (*kSearch)(std::span<const PlaneWaveSteps>, const ScaleSteps&, const AngleGrid&)>
void search_of_the_paper(benchmark::State& state) {
  const auto antennas = paper_antennas();
  const AngleGrid grid(kAngles);
  SpectrumMaximum found;
  for (auto _ : state) {
    found = kSearch(antennas, kScales, grid);
    benchmark::DoNotOptimize(found);
  }
  state.counters["terms"] = static_cast<double>(found.terms);
}
BENCHMARK(search_of_the_paper<search_full_grid>)->Name("paper_grid_full")->Unit(benchmark::kMillisecond);
BENCHMARK(search_of_the_paper<search_bounded>)->Name("paper_grid_bounded")->Unit(benchmark::kMillisecond);

constexpr int kReads = 24, kGroups = 2;

void spherical_wave_double_std_cos(benchmark::State& state) {
  Random random(2);
  const auto reads = testing::random_reads(random, kReads, kGroups);
  std::vector<reference::SphericalRead> exact;
  for (const SphericalWaveRead& r : reads)
    exact.push_back({{r.antenna_m[0], r.antenna_m[1], r.antenna_m[2]}, r.turns_per_m, 1e-4 * r.phase_q16, r.group});
  for (auto _ : state)
    for (int cell = 0; cell < kBlockCells; ++cell)
      benchmark::DoNotOptimize(reference::power(exact, {1.0 + 0.05 * (cell / 16), 2.0, 0.05 * (cell % 16)}));
  count_terms(state, kBlockCells * kReads);
}
BENCHMARK(spherical_wave_double_std_cos);

void spherical_wave_float_block(benchmark::State& state) {
  Random random(2);
  const auto reads = testing::random_reads(random, kReads, kGroups);
  const CellBlock block = testing::random_block(random, 2.0);
  for (auto _ : state) benchmark::DoNotOptimize(bench::float_block_power(reads, block));
  count_terms(state, kBlockCells * kReads);
}
BENCHMARK(spherical_wave_float_block);

void spherical_wave_kernel(benchmark::State& state) {
  hwy::SetSupportedTargetsForTest(state.range(0));
  Random random(2);
  SphericalWaveSpectrum spectrum(testing::random_reads(random, kReads, kGroups));
  const CellBlock block = testing::random_block(random, 2.0);
  BlockPower power;
  for (auto _ : state) {
    spectrum.evaluate(block, power);
    benchmark::DoNotOptimize(power);
  }
  count_terms(state, kBlockCells * kReads);
  hwy::SetSupportedTargetsForTest(0);
}
BENCHMARK(spherical_wave_kernel)->Apply(each_target)->ArgName("hwy_target");

}  // namespace
}  // namespace rfmvo
