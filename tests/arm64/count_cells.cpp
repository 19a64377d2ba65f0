// Evaluates a kernel so many times: `count_cells plane|spherical TIMES`. Prints cells times terms of one time.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "kernels/plane_wave_search.hpp"
#include "kernels/scenes.hpp"

namespace rfmvo {
namespace {

// The paper's grid, one antenna.
double plane(int times) {
  testing::Random random(1);
  const auto steps = testing::plane_wave_steps(random, 59, testing::Motion::kTurning, 0.3);
  const ScaleSteps scales{.first = 0.5F, .step = 0.1F, .count = 16};
  const PlaneWaveSpectrum spectrum(steps, scales);
  const AngleGrid grid(37);
  std::vector<std::int32_t> sums(grid.size() * 16);
  for (int i = 0; i < times; ++i) spectrum.evaluate(grid.directions(), 0, scales.count, sums);
  return static_cast<double>(sums.size()) * 59;
}

double spherical(int times) {
  testing::Random random(2);
  SphericalWaveSpectrum spectrum(testing::random_reads(random, 24, 2));
  const CellBlock block = testing::random_block(random, 2.0);
  BlockPower power;
  for (int i = 0; i < times; ++i) spectrum.evaluate(block, power);
  return kBlockCells * 24.0;
}

}  // namespace
}  // namespace rfmvo

int main(int argc, char** argv) {
  if (argc != 3) return 1;
  const int times = std::atoi(argv[2]);
  std::printf("%.0f\n", std::string_view(argv[1]) == "plane" ? rfmvo::plane(times) : rfmvo::spherical(times));
}
