#include "estimator/joint_estimator.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.hpp"
#include "estimator/accuracy_estimation.hpp"
#include "estimator/joint_segment.hpp"

namespace rfmvo {

struct JointEstimator::Impl {
  Config config;
  Calibration calibration;
  std::vector<JointSegment> segments;
  DeviceTime last_solve;
  std::uint32_t last_revision = 0;
};

namespace {

struct ClosestApproach {
  PathPose pose;
  double distance_m = std::numeric_limits<double>::infinity();
};

ClosestApproach closest_approach(const JointSegment& segment, const Eigen::Vector3d& p_W_X) {
  ClosestApproach best;
  for (const PathPose& pose : segment.path().poses()) {
    const double d = (segment.T_W_C(pose).t - p_W_X).norm();
    if (d < best.distance_m) best = {pose, d};
  }
  return best;
}

// p_C_X = R_W_C^T (x - p_W_C): covariance from the joint one of tag and path.
Eigen::Matrix3d camera_relative_covariance(const JointSegment& segment, const SegmentTag& tag, const PathPose& pose,
                                           const Eigen::Vector3d& p_W_X) {
  const Rigid3 T_W_C = segment.T_W_C(pose);
  const Eigen::Matrix3d R_C_W = T_W_C.R.conjugate().toRotationMatrix();
  if (tag.shared_covariance.size() == 0) return R_C_W * tag.covariance.topLeftCorner<3, 3>() * R_C_W.transpose();
  const Eigen::MatrixXd J_pose = segment.pose_jacobian(pose);
  // exp(theta) turns the camera: p_C_X changes by R_C_W skew(x - p) theta.
  const Eigen::MatrixXd J = -J_pose.topRows<3>() + skew(p_W_X - T_W_C.t) * J_pose.bottomRows<3>();
  const Eigen::MatrixXd cross = J * tag.shared_covariance.topRows<3>().transpose();  // 3 x 3
  const Eigen::Matrix3d in_W = tag.covariance.topLeftCorner<3, 3>() + cross + cross.transpose() +
                               J * segment.shared_covariance().shared * J.transpose();
  return R_C_W * in_W * R_C_W.transpose();
}

// What a rotation of unknown axis by sigma does to a point at r: sigma^2 (|r|^2 I - r r^T). The phases see the path;
// the camera's orientation on it is the odometry's and the mounting's.
Eigen::Matrix3d rotation_covariance(const Eigen::Vector3d& r, double sigma_rad) {
  return sigma_rad * sigma_rad * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

// Second moment of a tag's other modes about the heaviest: what its covariance lacks while they are open.
Eigen::Matrix3d spread_of_modes(const SegmentTag& tag) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const TagMode& mode : tag.modes) {
    const Eigen::Vector3d away = mode.tag.p_W_X - tag.state.p_W_X;
    spread += mode.weight * away * away.transpose();
  }
  return spread;
}

// What other solutions of the segment say of a tag: second moments about the published position, in W and relative
// to the camera at one pose of the path, and the probability that it is somewhere else altogether.
struct OtherSolutions {
  Eigen::Matrix3d spread_W = Eigen::Matrix3d::Zero(), spread_C = Eigen::Matrix3d::Zero();
  double elsewhere = 0.0;
};

OtherSolutions other_solutions(const JointSegment& segment, const Epc& epc, const TagEstimate& e,
                               const PathPose& pose) {
  constexpr double kElsewhere_m = 0.15;
  OtherSolutions others;
  const std::vector<double> weights = segment.weights();
  for (std::size_t r = 0; r < segment.rivals().size(); ++r) {
    const JointSegment& rival = segment.rivals()[r];
    const SegmentTag& tag = rival.tags().at(epc);
    if (!tag.placed) continue;
    const Eigen::Vector3d p_W_X = rival.to_W(tag.state.p_W_X);
    const Eigen::Vector3d in_W = p_W_X - e.p_W_X_m, in_C = rival.T_W_C(pose).inverse() * p_W_X - e.p_C_X_m;
    others.spread_W += weights[r + 1] * in_W * in_W.transpose();
    others.spread_C += weights[r + 1] * in_C * in_C.transpose();
    if (in_C.norm() > kElsewhere_m) others.elsewhere += weights[r + 1];
  }
  return others;
}

struct Accuracy {
  double hdop = 0.0, bearing_sweep_rad = 0.0, independent_reads = 0.0;
  std::optional<Eigen::Matrix3d> circle;  // see circle_through()
};

// Antenna places on a line, nearly: any turn about it leaves the phases as they are. Then the second moment about p of
// the circle through p, over all turns: 3/2 r^2 towards the line, 1/2 r^2 along the circle.
std::optional<Eigen::Matrix3d> circle_through(const Eigen::Vector3d& p, const std::vector<Eigen::Vector3d>& places) {
  constexpr double kLine_m = 0.08;  // a quarter wavelength
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& a : places) mean += a / static_cast<double>(places.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& a : places) spread += (a - mean) * (a - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread / static_cast<double>(places.size()));
  if (axes.eigenvalues()[1] > kLine_m * kLine_m) return std::nullopt;
  const Eigen::Vector3d along = axes.eigenvectors().col(2);
  const Eigen::Vector3d radius = (p - mean) - along.dot(p - mean) * along, tangent = along.cross(radius);
  return Eigen::Matrix3d(1.5 * radius * radius.transpose() + 0.5 * tangent * tangent.transpose());
}

Accuracy accuracy_of(const JointSegment& segment, const SegmentTag& tag, const Eigen::Vector3d& p_W_X,
                     double length_m) {
  Accuracy a;
  std::vector<Eigen::Vector3d> antennas;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& chain : tag.chains) {
    std::size_t previous = antennas.size();
    const std::size_t first = previous;
    for (const SegmentTag::Read& r : chain) {
      antennas.push_back(segment.antenna_W(r));
      mean += (p_W_X - antennas.back()).normalized();
      // Travel shorter than about two correlation lengths brings no new structured error.
      const double moved = antennas.size() - 1 == first ? 1e9 : (antennas.back() - antennas[previous]).norm();
      if (moved > 2.0 * length_m) {
        a.independent_reads += 1.0;
        previous = antennas.size() - 1;
      }
    }
  }
  for (const Eigen::Vector3d& p : antennas) {
    const double cosine = std::clamp((p_W_X - p).normalized().dot(mean.normalized()), -1.0, 1.0);
    a.bearing_sweep_rad = std::max(a.bearing_sweep_rad, 2.0 * std::acos(cosine));
  }
  a.hdop = horizontal_dilution(antennas, p_W_X).value;
  a.circle = circle_through(p_W_X, antennas);
  return a;
}

// elsewhere: probability of other solutions that have the tag at another place.
bool ambiguous(const SegmentTag& tag, double elsewhere) {
  constexpr double kSecondModeMatters = 0.02;
  return (tag.modes.empty() ? 0.0 : 1.0 - tag.modes[0].weight) + elsewhere > kSecondModeMatters;
}

TagStatus status_of(const JointSegment& segment, const SegmentTag& tag, bool undecided, bool line,
                    const Eigen::Matrix3d& covariance_m2, DeviceTime now, const JointConfig& config) {
  if (!segment.started() || !tag.placed) return tag.placed ? TagStatus::kNoScale : TagStatus::kTooFewReads;
  if (!segment.scale_observable()) return TagStatus::kNoScale;
  if (undecided) return line ? TagStatus::kCircle : TagStatus::kMirror;
  if ((now - tag.last_read).seconds() > config.stale_after_s) return TagStatus::kStale;
  const double sigma_m = std::sqrt(covariance_m2.trace());
  return sigma_m > config.located_sigma_max_m ? TagStatus::kWeakGeometry : TagStatus::kConverged;
}

TagEstimate describe(const JointSegment& segment, const Epc& epc, const SegmentTag& tag, DeviceTime now,
                     double camera_rotation_sigma_rad, const JointConfig& config) {
  TagEstimate e;
  e.time = now;
  e.epc = epc;
  e.segment = segment.id();
  e.map_revision = segment.revision();
  e.reads = tag.reads;
  e.status = TagStatus::kTooFewReads;
  if (!tag.placed) return e;

  const Eigen::Vector3d p = segment.to_W(tag.state.p_W_X);
  e.p_W_X_m = p;
  e.covariance_m2 = tag.covariance.topLeftCorner<3, 3>();
  if (tag.shared_covariance.size() > 0)
    e.covariance_with_log_scale_m = tag.shared_covariance.block<3, 1>(0, SharedLayout::kLogScale);
  const ClosestApproach closest = closest_approach(segment, p);
  const Rigid3 T_W_C = segment.T_W_C(closest.pose);
  e.closest_approach = closest.pose.time;
  e.p_C_X_m = T_W_C.inverse() * p;
  e.covariance_C_m2 = camera_relative_covariance(segment, tag, closest.pose, p) +
                      rotation_covariance(e.p_C_X_m, camera_rotation_sigma_rad);
  e.covariance_m2 += rotation_covariance(p - T_W_C.t, camera_rotation_sigma_rad);
  const OtherSolutions others = other_solutions(segment, epc, e, closest.pose);
  e.covariance_m2 += others.spread_W;
  e.covariance_C_m2 += others.spread_C;
  const bool undecided = ambiguous(tag, others.elsewhere);
  const Accuracy accuracy = accuracy_of(segment, tag, p, config.correlation_length_m);
  e.hdop = accuracy.hdop;
  e.bearing_sweep_rad = accuracy.bearing_sweep_rad;
  e.independent_reads = accuracy.independent_reads;
  e.status = status_of(segment, tag, undecided, accuracy.circle.has_value(), e.covariance_C_m2, now, config);
  constexpr std::size_t kMaxHypotheses = 8;
  for (std::size_t i = 0; i < std::min(tag.modes.size(), kMaxHypotheses); ++i) {
    const TagMode& mode = tag.modes[i];
    constexpr double kWorthTelling = 0.005;
    const bool first = i == 0;  // the first one is the published position, refined since
    if (!first && mode.weight < kWorthTelling) break;
    e.hypotheses.push_back({first ? p : segment.to_W(mode.tag.p_W_X),
                            first ? e.covariance_m2 : Eigen::Matrix3d(mode.covariance.topLeftCorner<3, 3>()),
                            mode.weight});
  }
  if (!undecided) return e;
  // Who looks at the covariance alone must not take an undecided position for a good one.
  const Eigen::Matrix3d spread = accuracy.circle.value_or(spread_of_modes(tag)),
                        R_C_W = T_W_C.R.conjugate().toRotationMatrix();
  e.covariance_m2 += spread;
  e.covariance_C_m2 += R_C_W * spread * R_C_W.transpose();
  return e;
}

Trajectory describe_path(const JointSegment& segment, DeviceTime now) {
  Trajectory t;
  t.time = now;
  t.segment = segment.id();
  t.map_revision = segment.revision();
  for (const PathPose& pose : segment.path().poses())
    t.poses.push_back(
        {pose.time, segment.id(), segment.revision(), segment.T_W_C(pose), segment.pose_covariance(pose)});
  return t;
}

}  // namespace

JointEstimator::JointEstimator(const Config& config, const Calibration& calibration) : impl_(std::make_unique<Impl>()) {
  impl_->config = config;
  impl_->calibration = calibration;
}
JointEstimator::~JointEstimator() = default;

void JointEstimator::on(const CameraPose& pose) {
  if (pose.status != VoStatus::kTracking && pose.status != VoStatus::kDegraded) return;
  auto& segments = impl_->segments;
  if (segments.empty() || segments.back().id() != pose.segment) {
    // A new segment starts where the last one was left, as far as is known; the first at the origin.
    Rigid3 T_W_C0 = impl_->calibration.T_B_C;
    if (!segments.empty() && !segments.back().path().empty())
      T_W_C0 = segments.back().T_W_C(segments.back().path().poses().back());
    segments.emplace_back(impl_->config, impl_->calibration, pose.segment, T_W_C0);
  }
  segments.back().add(pose);
}

void JointEstimator::on(const SampledRead& read) {
  for (JointSegment& segment : impl_->segments)
    if (segment.id() == read.segment) segment.add(read);
}

std::uint64_t JointEstimator::reads_rejected() const {
  std::uint64_t n = 0;
  for (const JointSegment& s : impl_->segments) n += s.reads_rejected();
  return n;
}

void JointEstimator::publish(DeviceTime now, bool final, std::vector<Estimate>& out) {
  auto& segments = impl_->segments;
  if (segments.empty()) return;
  if (final)
    for (JointSegment& s : segments) s.solve(true);
  else
    segments.back().solve(false);

  // The best answer per tag: the segment with the smallest honest sigma.
  std::map<Epc, TagEstimate> best;
  const auto sigma = [](const TagEstimate& e) {
    return e.status == TagStatus::kTooFewReads
               ? 1e9
               : e.covariance_C_m2.trace() + (e.status == TagStatus::kNoScale ? 1e6 : 0.0);
  };
  std::uint32_t revision = 0;
  for (const JointSegment& s : segments) {
    revision += s.revision();
    for (const auto& [epc, tag] : s.tags()) {
      const TagEstimate e =
          describe(s, epc, tag, now, impl_->calibration.camera_rotation_sigma_rad, impl_->config.joint);
      const auto place = best.find(epc);
      if (place == best.end() || sigma(e) < sigma(place->second)) best[epc] = e;
    }
    out.emplace_back(ScaleEstimate{now, s.id(), s.scale_observable(), s.started() ? s.scale_m_per_unit() : 0.0,
                                   s.started() ? s.log_scale_sigma() : 0.0});
    if (s.started() && (final || &s == &segments.back())) out.emplace_back(describe_path(s, now));
  }
  for (auto& [epc, e] : best) out.emplace_back(std::move(e));
  if (revision != impl_->last_revision)
    out.emplace_back(MapRevision{now, revision, final ? "final solution" : "new reads"});
  impl_->last_revision = revision;
}

std::optional<MetricPose> JointEstimator::newest_pose() const {
  if (impl_->segments.empty()) return std::nullopt;
  const JointSegment& s = impl_->segments.back();
  if (!s.scale_observable() || s.path().empty()) return std::nullopt;
  const PathPose& pose = s.path().poses().back();
  return MetricPose{pose.time, s.id(), s.revision(), s.T_W_C(pose), s.pose_covariance(pose)};
}

}  // namespace rfmvo
