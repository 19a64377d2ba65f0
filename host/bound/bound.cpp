#include "bound/bound.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "bound/information.hpp"
#include "evaluate/evaluation.hpp"

namespace rfmvo::bound {
namespace {

TagBound tag_bound(std::size_t tag, const World& world, const Columns& columns, const Information& information) {
  const std::size_t frame = columns.closest_frame(tag);
  TagBound result;
  result.epc = world.tags[tag].epc;
  for (const Read& read : world.reads) result.reads += read.tag == tag ? 1 : 0;
  result.distance_m = (world.T_S_C(world.frame_times_s[frame]).t - world.tags[tag].p_S_X_m).norm();
  result.covariance_C_m2 = information.covariance(columns.of_tag_in_camera(tag, frame));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(result.covariance_C_m2, Eigen::EigenvaluesOnly);
  if (axes.eigenvalues().maxCoeff() < kUnbounded_m * kUnbounded_m)
    result.sigma_m = std::sqrt(result.covariance_C_m2.trace());
  return result;
}

std::optional<double> scale_bound(const Columns& columns, const Information& information) {
  if (!columns.has_path()) return std::nullopt;
  const Eigen::RowVectorXd row = columns.of_path_scale();
  if (row.isZero(0.0)) return std::nullopt;  // no travel, no scale
  const double sigma = std::sqrt(information.covariance(row)(0, 0));
  return sigma < kUnboundedScale ? std::optional(sigma) : std::nullopt;
}

}  // namespace

Settings settings_for(const simulate::Options& options) {
  Settings settings;
  settings.time_offset_sigma_s = std::abs(options.reader_delay_s);
  return settings;
}

Bound bound_of(const World& world, const Settings& settings) {
  const Columns columns(world, settings);
  const Information information(world, columns);
  Bound bound;
  std::vector<double> sigmas_m;
  for (std::size_t tag = 0; tag < world.tags.size(); ++tag) {
    bound.tags.push_back(tag_bound(tag, world, columns, information));
    if (bound.tags.back().sigma_m) sigmas_m.push_back(*bound.tags.back().sigma_m);
  }
  bound.unbounded = world.tags.size() - sigmas_m.size();
  if (const auto summary = evaluate::summarise(sigmas_m)) {
    bound.rmse_m = summary->rmse;
    bound.median_m = summary->median;
  }
  bound.scale_relative = scale_bound(columns, information);
  return bound;
}

}  // namespace rfmvo::bound
