// The joint solver on a full map: 500 tags, 120 reads each, from a state a few millimetres off.
#include <benchmark/benchmark.h>

#include <random>

#include "estimator/joint_solver.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kPlaces = 4, kTags = 500;  // many tags at each place, as in boxes on a pallet

struct Resolve {
  joint_scene::World world = joint_scene::make_world(kPlaces, 60, 1.5);
  JointState near;
};

const Resolve& resolve() {
  static const Resolve r = [] {
    Resolve made;
    for (std::size_t t = kPlaces; t < kTags; ++t) {
      made.world.problem.reads.push_back(made.world.problem.reads[t % kPlaces]);
      made.world.truth.tags.push_back(made.world.truth.tags[t % kPlaces]);
    }
    made.near = made.world.truth;
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (auto& reads : made.world.problem.reads)
      for (JointRead& read : reads) read.phase_rad += 0.1 * normal(random);
    for (TagState& tag : made.near.tags)
      tag.p_W_X += 0.003 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    made.near.log_scale += 0.001;
    return made;
  }();
  return r;
}

void joint_resolve_500_tags_120_reads(benchmark::State& state) {
  const Resolve& r = resolve();
  int iterations = 0;
  for (auto _ : state) {
    JointState at = r.near;
    iterations = solve(r.world.problem, {}, at).iterations;
    benchmark::DoNotOptimize(at);
  }
  state.counters["iterations"] = iterations;
}
BENCHMARK(joint_resolve_500_tags_120_reads)->Unit(benchmark::kMillisecond);

void joint_covariance_500_tags_120_reads(benchmark::State& state) {
  const Resolve& r = resolve();
  for (auto _ : state) benchmark::DoNotOptimize(covariance(r.world.problem, r.world.truth));
}
BENCHMARK(joint_covariance_500_tags_120_reads)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rfmvo
