#include "montecarlo/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "evaluate/last_estimates.hpp"

namespace rfmvo::montecarlo {
namespace {

// Nothing for a covariance that claims certainty or nonsense.
std::optional<double> published_sigma_m(const evaluate::TagEvaluation& tag) {
  const double trace = tag.estimate->covariance_C_m2.trace();
  return std::isfinite(trace) && trace > 0.0 ? std::optional(std::sqrt(trace)) : std::nullopt;
}

// Smallest value that at least `share` of the values do not exceed.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// Tags that have both.
struct Compared {
  std::vector<double> errors_m, bounds_m, with_lobes_m, wrong_probability;
};

struct Pool {
  std::vector<double> errors_m, known_path_m, nees, scale_errors, scale_bounds, read_s;
  Compared unknown_path, known_path;
  std::size_t compared = 0, inside = 0;
};

void add_tag(const evaluate::TagEvaluation& tag, Statistics& s, Pool& pool) {
  ++s.tags;
  ++s.statuses[tag.estimate ? evaluate::label_of(tag.estimate->status) : "NOT_SEEN"];
  if (!tag.located) return;
  ++s.located;
  const auto sigma_m = published_sigma_m(tag);
  if (sigma_m && *sigma_m < kLocatedSigma_m) ++s.located_sigma25;
  if (!tag.camera_relative_error_m) return;
  pool.errors_m.push_back(*tag.camera_relative_error_m);
  ++pool.compared;
  if (tag.nees_camera) {
    pool.nees.push_back(*tag.nees_camera);
    if (*tag.nees_camera <= evaluate::kChi2_95_3dof) ++pool.inside;
  }
  if (!is_unflagged_wrong(tag)) return;
  ++s.unflagged_wrong;
  if (*tag.camera_relative_error_m > kMatters_m) ++s.unflagged_wrong_that_matters;
}

// All lists are in the truth's order.
void add_bound(const evaluate::TagsEvaluation& tags, const bound::Bound& bound, const bound::Lobes* lobes,
               Compared& compared) {
  for (std::size_t i = 0; i < tags.tags.size(); ++i) {
    if (!tags.tags[i].camera_relative_error_m || !bound.tags[i].sigma_m) continue;
    compared.bounds_m.push_back(*bound.tags[i].sigma_m);
    compared.errors_m.push_back(*tags.tags[i].camera_relative_error_m);
    if (lobes == nullptr) continue;
    compared.with_lobes_m.push_back(*bound::rmse_with_lobes_m(bound.tags[i], lobes->tags[i]));
    compared.wrong_probability.push_back(lobes->tags[i].wrong_probability);
  }
}

void add_run(const SeedRun& run, Statistics& s, Pool& pool) {
  for (const auto& tag : run.evaluation.tags.tags) add_tag(tag, s, pool);
  if (run.known_path) {
    for (const auto& tag : run.known_path->tags.tags) {
      if (tag.camera_relative_error_m) pool.known_path_m.push_back(*tag.camera_relative_error_m);
    }
  }
  if (run.bound) {
    s.unbounded += run.bound->unbounded;
    add_bound(run.evaluation.tags, *run.bound, run.lobes ? &*run.lobes : nullptr, pool.unknown_path);
  }
  if (run.known_path && run.known_path_bound)
    add_bound(run.known_path->tags, *run.known_path_bound, nullptr, pool.known_path);
  if (run.evaluation.scale.relative_error) {
    pool.scale_errors.push_back(*run.evaluation.scale.relative_error);
    if (run.bound && run.bound->scale_relative) pool.scale_bounds.push_back(*run.bound->scale_relative);
  }
  pool.read_s.insert(pool.read_s.end(), run.timing.read_s.begin(), run.timing.read_s.end());
}

std::size_t converged(const Statistics& s) {
  const auto found = s.statuses.find(evaluate::label_of(TagStatus::kConverged));
  return found == s.statuses.end() ? 0 : found->second;
}

void add_times(const std::vector<SeedRun>& runs, Statistics& s) {
  double span_s = 0.0, cpu_s = 0.0, wall_s = 0.0;
  for (const SeedRun& run : runs) {
    span_s += run.timing.span_s;
    cpu_s += run.timing.cpu_s;
    wall_s += run.timing.wall_s;
  }
  if (!runs.empty()) s.run_s = wall_s / static_cast<double>(runs.size());
  if (cpu_s > 0.0) s.realtime_factor = span_s / cpu_s;
}

}  // namespace

bool is_unflagged_wrong(const evaluate::TagEvaluation& tag) {
  if (!tag.estimate || tag.estimate->status != TagStatus::kConverged || !tag.camera_relative_error_m) return false;
  const auto sigma_m = published_sigma_m(tag);
  if (!sigma_m || !tag.nees_camera) return true;
  const double error_m = *tag.camera_relative_error_m;
  return *tag.nees_camera > kChi2_1em6_3dof || (error_m > kExcusedSigmas * *sigma_m && error_m > kMatters_m);
}

Statistics statistics_of(const std::vector<SeedRun>& runs, const Options& options) {
  Statistics s;
  Pool pool;
  s.seeds = runs.size();
  for (const SeedRun& run : runs) add_run(run, s, pool);
  s.error_m = evaluate::summarise(pool.errors_m);
  if (const auto bounds = evaluate::summarise(pool.unknown_path.bounds_m)) {
    s.bound_rmse_m = bounds->rmse;
    s.bound_median_m = bounds->median;
    s.ratio = evaluate::summarise(pool.unknown_path.errors_m)->rmse / bounds->rmse;
  }
  if (const auto bounds = evaluate::summarise(pool.unknown_path.with_lobes_m)) {
    s.lobe_bound_rmse_m = bounds->rmse;
    s.lobe_ratio = evaluate::summarise(pool.unknown_path.errors_m)->rmse / bounds->rmse;
    s.lobe_wrong_share = evaluate::summarise(pool.unknown_path.wrong_probability)->mean;
  }
  if (const auto bounds = evaluate::summarise(pool.known_path.bounds_m)) s.known_path_bound_rmse_m = bounds->rmse;
  if (const auto known = evaluate::summarise(pool.known_path_m)) s.known_path_rmse_m = known->rmse;
  if (pool.compared > 0) s.coverage95 = static_cast<double>(pool.inside) / static_cast<double>(pool.compared);
  if (const auto nees = evaluate::summarise(pool.nees)) {
    s.nees_mean = nees->mean;
    s.nees_median = nees->median;
  }
  if (const auto scale = evaluate::summarise(pool.scale_errors)) s.scale_rms_relative = scale->rmse;
  if (const auto bounds = evaluate::summarise(pool.scale_bounds)) s.scale_bound_rms_relative = bounds->rmse;
  s.scales = pool.scale_errors.size();
  const bool images = !options.simulation.images_dir.empty();
  if (images || !simulate::is_degenerate_scene(options.simulation.scene)) s.false_alarms = s.tags - converged(s);
  s.per_read_p99_s = quantile(pool.read_s, 0.99);
  add_times(runs, s);
  return s;
}

}  // namespace rfmvo::montecarlo
