#include "vision/bundle_adjustment.hpp"

#include <algorithm>

#include "base/assert.hpp"
#include "vision/bundle_system.hpp"

namespace rfmvo {
namespace {

constexpr int kLens = LensVector::SizeAtCompileTime;

constexpr double kInitialDamping = 1e-4;
constexpr double kMinDamping = 1e-8;  // keeps a free gauge solvable
constexpr double kMaxDamping = 1e4;
constexpr double kCostDone = 1e-3;  // relative: a further step changes poses by less than their noise

// Takes the system's step if it makes the cost smaller.
bool accept(const BundleSystem& system, BundleProblem& problem, double& best_cost) {
  std::vector<BundleView> views = problem.views;
  std::vector<Eigen::Vector3d> points = problem.points_V;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const int s = system.slot(v);
    if (s >= 0) views[v].T_C_V = moved(views[v].T_C_V, system.step_camera().segment<6>(6 * s));
  }
  for (std::size_t p = 0; p < points.size(); ++p) points[p] += system.step_points()[p];
  LensVector lens = problem.lens.step;
  if (system.has_lens()) lens += system.step_camera().tail<kLens>();
  const double now = system.cost(views, points, lens);
  if (!(now < best_cost)) return false;
  problem.views.swap(views);
  problem.points_V.swap(points);
  problem.lens.step = lens;
  best_cost = now;
  return true;
}

// What is left for the lens when all else is free to follow it: the last block of the factor.
void ask_lens(BundleSystem& system, const BundleProblem& problem, BundleReport& report) {
  if (!system.has_lens()) return;
  system.linearise();
  if (!system.reduce(kMinDamping)) return;
  LensMatrix L = system.factor().matrixLLT().bottomRightCorner<kLens, kLens>();
  L(0, 1) = 0.0;
  const LensMatrix& known = problem.lens.information;
  report.lens_information = L * L.transpose() - known;
  const LensVector of_known = known * (problem.lens.expected - problem.lens.step);
  report.lens_pull = L * system.factor().matrixL().solve(system.right_side()).tail<kLens>() - of_known;
}

}  // namespace

BundleReport adjust_bundle(BundleProblem& problem, const BundleOptions& options) {
  RFMVO_ASSERT(std::is_sorted(problem.observations.begin(), problem.observations.end(),
                              [](const auto& a, const auto& b) { return a.point < b.point; }));
  BundleSystem system(problem, options);
  BundleReport report;
  report.initial_cost = report.final_cost = system.cost(problem.views, problem.points_V, problem.lens.step);
  double damping = kInitialDamping;
  bool fresh = false;
  while (report.iterations < options.max_iterations && damping < kMaxDamping) {
    if (!fresh) system.linearise();
    fresh = true;
    ++report.iterations;
    const double before = report.final_cost;
    if (!system.step(damping) || !accept(system, problem, report.final_cost)) {
      damping *= 10.0;
      continue;
    }
    fresh = false;
    damping = std::max(0.1 * damping, kMinDamping);
    if (before - report.final_cost < kCostDone * before) break;
  }
  ask_lens(system, problem, report);
  return report;
}

}  // namespace rfmvo
