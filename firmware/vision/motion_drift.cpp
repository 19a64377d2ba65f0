#include "vision/motion_drift.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "vision/bundle_system.hpp"
#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

constexpr double kSlack_s = 0.02;       // of the horizon: frames do not fall on it
constexpr std::size_t kMinPoints = 20;  // twice as many as unknowns of a motion, at least
constexpr double kBundleHuber_px = 1.0;
constexpr double kTinyDamping = 1e-10;
constexpr double kScaleHeld_px2 = 1e12;  // information of ln(scale): 1e-6 at a pixel
// The live pose at the motion's start was as new as the one at its end: it had no later views to lean on either.
constexpr double kEnds = 2.0;
// The scale wanders from window to window. Against its mean over a run of n windows it is off by n / 3 windows' worth;
// after this many, whoever uses the poses must let the scale drift himself.
constexpr double kScaleWindows = 10.0;
constexpr double kRegion_rad = 0.3;  // a region's width and height, seen from the motion's start; in depth an octave

// A step of the motion's end and one of ln(scale) after its start against that before; one column each over the
// unknowns of the reduced system.
constexpr int kAsked = 7;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, kAsked>;
using Vector7d = Eigen::Matrix<double, kAsked, 1>;
using Matrix7d = Eigen::Matrix<double, kAsked, kAsked>;

struct Span {
  std::int64_t first = 0, from = 0;  // key frames: of the window, and where the motion starts
};

// The motion starts a horizon before the newest key frame, the window another horizon earlier: that holds the scale.
Span span_of(const Map& map) {
  const Keyframe& newest = map.keyframes.back();
  Span span{newest.id, map.keyframes.front().id};
  for (const Keyframe& k : map.keyframes) {
    const double age_s = (newest.time - k.time).seconds();
    if (age_s >= kDriftHorizon_s - kSlack_s) span.from = k.id;
    if (age_s <= 2.0 * kDriftHorizon_s + kSlack_s) span.first = std::min(span.first, k.id);
  }
  span.first = std::min(span.first, span.from);
  return span;
}

BundleObservation observed(const Keyframe& keyframe, const KeyframeObservation& o, const Eigen::Vector3d& p_V,
                           const Lens& lens) {
  const Eigen::Vector3d p_C = keyframe.T_C_V * p_V;
  return {.measured = lens.at_stamp(o.normalised, o.px.y, p_C, keyframe.twist),
          .d_lens = lens.d_at_stamp(o.normalised, o.px.y, p_C, keyframe.twist),
          .scale = image_scale(lens.camera(), o.normalised)};
}

BundleProblem gather(const Map& map, const Lens& lens, const Span& span) {
  BundleProblem bundle;
  for (std::int64_t id = span.first; id <= map.keyframes.back().id; ++id)
    bundle.views.push_back({map.find(id)->T_C_V, id == span.from});
  for (const auto& [id, landmark] : map.landmarks) {
    const auto seen = std::count_if(landmark.observations.begin(), landmark.observations.end(),
                                    [&span](const auto& o) { return o.keyframe >= span.first; });
    if (!landmark.located || seen < 2) continue;
    for (const KeyframeObservation& o : landmark.observations) {
      if (o.keyframe < span.first) continue;
      bundle.observations.push_back(observed(*map.find(o.keyframe), o, landmark.p_V, lens));
      bundle.observations.back().view = static_cast<int>(o.keyframe - span.first);
      bundle.observations.back().point = static_cast<int>(bundle.points_V.size());
    }
    bundle.points_V.push_back(landmark.p_V);
  }
  return bundle;
}

double variance_px2(const BundleSystem& system, const BundleProblem& bundle) {
  const double unknowns = system.size() + 3.0 * static_cast<double>(bundle.points_V.size());
  const double freedom = 2.0 * static_cast<double>(bundle.observations.size()) - unknowns;
  return system.cost(bundle.views, bundle.points_V, bundle.lens.step) / std::max(freedom, 1.0);
}

// d ln(scale) of the views first .. last - 1, seen from another one, over the reduced system's unknowns.
Eigen::VectorXd d_scale(const BundleSystem& system, const BundleProblem& bundle, std::size_t origin, std::size_t first,
                        std::size_t last) {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(system.size());
  double sum = 0.0;
  for (std::size_t v = first; v < last; ++v) {
    if (system.slot(v) < 0) continue;
    const ViewPose& T = bundle.views[v].T_C_V;
    const Eigen::Vector3d away = T.centre() - bundle.views[origin].T_C_V.centre();
    d.segment<3>(6 * system.slot(v) + 3) = -(T.R_C_V * away);
    sum += away.squaredNorm();
  }
  return sum > 0.0 ? Eigen::VectorXd(d / sum) : Eigen::VectorXd();
}

Matrix6d root(const Matrix6d& covariance, bool inverse) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(covariance);
  const double least = 1e-9 * eigen.eigenvalues().maxCoeff();
  const Vector6d roots = eigen.eigenvalues().cwiseMax(least).cwiseSqrt();
  return eigen.eigenvectors() * (inverse ? Vector6d(roots.cwiseInverse()) : roots).asDiagonal() *
         eigen.eigenvectors().transpose();
}

// In every direction the larger of the two.
Matrix6d larger(const Matrix6d& a, const Matrix6d& b) {
  const Matrix6d to_white = root(a, true);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(to_white * b * to_white);
  const Matrix6d back = root(a, false) * eigen.eigenvectors();
  return back * eigen.eigenvalues().cwiseMax(1.0).asDiagonal() * back.transpose();
}

using Region = std::array<int, 3>;

Region region_of(const Eigen::Vector3d& p_C) {
  const double z = std::max(p_C.z(), kMinDepth);
  const auto cell = [z](double x) { return static_cast<int>(std::floor(std::clamp(x / z, -1e3, 1e3) / kRegion_rad)); };
  return {cell(p_C.x()), cell(p_C.y()), std::ilogb(z)};
}

Matrix7d scatter(const BundleSystem& system, const BundleProblem& bundle, std::size_t from, const Columns& through) {
  Matrix7d by_landmark = Matrix7d::Zero(), by_region = Matrix7d::Zero();
  std::map<Region, Vector7d> regions;
  for (std::size_t p = 0; p < bundle.points_V.size(); ++p) {
    const Vector7d pull = system.pull(p, through);
    by_landmark += pull * pull.transpose();
    const Region region = region_of(bundle.views[from].T_C_V * bundle.points_V[p]);
    regions.try_emplace(region, Vector7d::Zero()).first->second += pull;
  }
  for (const auto& [region, pull] : regions) by_region += pull * pull.transpose();
  Matrix7d result = by_landmark.cwiseMax(by_region);  // of the scale
  result.topLeftCorner<6, 6>() = larger(by_landmark.topLeftCorner<6, 6>(), by_region.topLeftCorner<6, 6>());
  return result;
}

}  // namespace

std::optional<Matrix6d> drift_per_keyframe(const Map& map, const Lens& lens, const MappingOptions& options) {
  const Span span = span_of(map);
  const std::int64_t newest = map.keyframes.back().id;
  if (span.from == newest) return std::nullopt;
  BundleProblem bundle = gather(map, lens, span);
  if (bundle.points_V.size() < kMinPoints) return std::nullopt;
  bundle.lens.free = !lens.is_certain();
  BundleSystem system(bundle, {options.focal_px, kBundleHuber_px, 1});
  const double noise_px2 = variance_px2(system, bundle);
  const LensMatrix lens_weight = noise_px2 * lens.covariance().inverse();
  bundle.lens.information = lens_weight;
  const auto from = static_cast<std::size_t>(span.from - span.first);
  const std::size_t views = bundle.views.size();
  const Eigen::VectorXd later = d_scale(system, bundle, from, from + 1, views);
  const Eigen::VectorXd earlier = from > 0 ? d_scale(system, bundle, from, 0, from) : later;
  if (earlier.size() == 0 || later.size() == 0) return std::nullopt;
  system.linearise();
  if (!system.reduce(kTinyDamping) || !system.hold(earlier, kScaleHeld_px2)) return std::nullopt;
  Columns asked = Columns::Zero(system.size(), kAsked);
  asked.block<6, 6>(6 * system.slot(views - 1), 0).setIdentity();
  asked.col(6) = later;
  const Columns through = system.factor().solve(asked);
  Matrix7d covariance = scatter(system, bundle, from, through);
  if (system.has_lens()) {
    const auto d_asked = lens_weight * through.bottomRows<LensVector::SizeAtCompileTime>();
    covariance += d_asked.transpose() * lens.covariance() * d_asked;
  }
  if (!covariance.allFinite()) return std::nullopt;

  const auto steps = static_cast<double>(newest - span.from);
  const double windows = std::min(static_cast<double>(newest) / steps, kScaleWindows);
  const ViewPose& last = bundle.views.back().T_C_V;
  const Eigen::Vector3d way = last.R_C_V * (last.centre() - bundle.views[from].T_C_V.centre());
  Matrix6d result = kEnds * covariance.topLeftCorner<6, 6>();
  result.bottomRightCorner<3, 3>() += windows / 3.0 * covariance(6, 6) * way * way.transpose();
  return result / steps;
}

}  // namespace rfmvo
