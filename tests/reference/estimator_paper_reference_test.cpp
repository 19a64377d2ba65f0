#include <gtest/gtest.h>

#include <cmath>

#include "estimator/accuracy_estimation.hpp"
#include "estimator/spatial_power_spectrum.hpp"
#include "reference/paper_reference.hpp"
#include "unit/estimator_paper_scene.hpp"

namespace rfmvo {
namespace {

using paper_scene::kPi;

struct Pair {
  AntennaArray array;
  paper_reference::Antenna reference;
};

// Spherical wave, noise and offset: nothing is at a maximum by construction.
Pair noisy_pair(const Eigen::Vector3d& tag_m, double offset_rad) {
  const auto path = paper_scene::weave(60, 1.0);
  auto phases = paper_scene::tag_phases(path, tag_m, offset_rad);
  for (std::size_t i = 0; i < phases.size(); ++i) phases[i] += 0.2 * paper_scene::wobble(static_cast<int>(i));
  Pair pair{paper_scene::array_of(path, phases, 1.3), {phases, {}, paper_scene::kWavelength_m}};
  for (const auto& p : path) pair.reference.camera.push_back({p.x() / 1.3, p.y() / 1.3, p.z() / 1.3});
  return pair;
}

TEST(PaperReference, SpatialPowerIsEquationSix) {
  const Pair pair = noisy_pair({1.0, 0.5, 1.9}, 0.7);
  for (int a = 0; a <= 180; a += 11)
    for (int b = 0; b <= 180; b += 13)
      for (const double gamma : {0.2, 1.0, 1.3, 4.0})
        EXPECT_NEAR(spatial_power(pair.array, {a * kPi / 180, b * kPi / 180}, gamma),
                    paper_reference::spatial_power(pair.reference, a * kPi / 180, b * kPi / 180, gamma), 1e-10);
}

TEST(PaperReference, SearchIsEquationEight) {
  const Pair one = noisy_pair({1.0, 0.5, 1.9}, 0.7), two = noisy_pair({1.3, -0.6, 1.4}, 2.9);
  const std::vector<AntennaArray> arrays{one.array, two.array};
  const double angle_step = 10 * kPi / 180;
  const ScaleRange range{0.6, 2.0};
  std::vector<double> gammas;
  for (int n = 0; n <= 10; ++n) gammas.push_back(0.6 + 0.13 * n);  // 0.1 of the middle, 1.3
  const SpectrumPeak peak = search_spectrum(arrays, range, angle_step, 0.1);
  const paper_reference::Peak reference = paper_reference::search({one.reference, two.reference}, angle_step, gammas);
  ASSERT_TRUE(peak.found);
  EXPECT_NEAR(peak.gamma, reference.gamma, 1e-12);
  EXPECT_NEAR(peak.power, reference.mean_power, 1e-9);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_NEAR(peak.angles[j].alpha_rad, reference.alpha[j], 1e-12);
    EXPECT_NEAR(peak.angles[j].beta_rad, reference.beta[j], 1e-12);
  }
}

TEST(PaperReference, HdopIsEquationTwentyEight) {
  std::vector<Eigen::Vector3d> antennas;
  std::vector<paper_reference::Point> points;
  for (const auto& p : paper_scene::weave(60, 1.0)) {
    antennas.push_back(p);
    points.push_back({p.x(), p.y(), p.z()});
  }
  for (const Eigen::Vector3d& tag : {Eigen::Vector3d(1.0, 1.5, 0.4), Eigen::Vector3d(-2.0, 0.7, 1.0)}) {
    const Hdop hdop = horizontal_dilution(antennas, tag);
    ASSERT_TRUE(hdop.defined);
    EXPECT_NEAR(hdop.value, paper_reference::hdop(points, {tag.x(), tag.y(), tag.z()}), 1e-10);
  }
}

}  // namespace
}  // namespace rfmvo
