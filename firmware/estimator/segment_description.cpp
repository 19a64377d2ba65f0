#include "estimator/segment_description.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "estimator/accuracy_estimation.hpp"
#include "estimator/principal_axes.hpp"
#include "estimator/tag_map.hpp"

namespace rfmvo {
namespace {

struct ClosestApproach {
  PathPose pose;
  double distance_m = std::numeric_limits<double>::infinity();
};

ClosestApproach closest_approach(const JointSegment& segment, const Eigen::Vector3d& p_L_X) {
  ClosestApproach best;
  for (const PathPose& pose : segment.path().poses()) {
    const double d = (segment.T_L_C(pose).t - p_L_X).norm();
    if (d < best.distance_m) best = {pose, d};
  }
  return best;
}

// p_C_X = R_L_C^T (x - p_L_C): covariance from the joint one of tag and path.
Eigen::Matrix3d camera_relative_covariance(const JointSegment& segment, const SegmentTag& tag, const PathPose& pose) {
  const Rigid3 T_L_C = segment.T_L_C(pose);
  const Eigen::Matrix3d R_C_L = T_L_C.R.conjugate().toRotationMatrix();
  if (tag.shared_covariance.size() == 0) return R_C_L * tag.covariance.topLeftCorner<3, 3>() * R_C_L.transpose();
  const Eigen::MatrixXd J_pose = segment.pose_jacobian(pose);
  // exp(theta) turns the camera: p_C_X changes by R_C_L skew(x - p) theta.
  const Eigen::MatrixXd J = -J_pose.topRows<3>() + skew(tag.state.p_W_X - T_L_C.t) * J_pose.bottomRows<3>();
  const Eigen::MatrixXd cross = J * tag.shared_covariance.topRows<3>().transpose();  // 3 x 3
  const Eigen::Matrix3d in_L = tag.covariance.topLeftCorner<3, 3>() + cross + cross.transpose() +
                               J * segment.shared_covariance().shared * J.transpose();
  return R_C_L * in_L * R_C_L.transpose();
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

// What other solutions of the segment say of a tag: second moments about the published position, in L and relative
// to the camera at one pose of the path, and the probability that it is somewhere else altogether.
struct OtherSolutions {
  Eigen::Matrix3d spread_L = Eigen::Matrix3d::Zero(), spread_C = Eigen::Matrix3d::Zero();
  double elsewhere = 0.0;
};

OtherSolutions other_solutions(const JointSegment& segment, const Epc& epc, const Eigen::Vector3d& p_L_X,
                               const PathPose& pose) {
  constexpr double kElsewhere_m = 0.15;
  OtherSolutions others;
  const Eigen::Vector3d p_C_X = segment.T_L_C(pose).inverse() * p_L_X;
  const std::vector<double> weights = segment.weights();
  for (std::size_t r = 0; r < segment.rivals().size(); ++r) {
    const JointSegment& rival = segment.rivals()[r];
    const SegmentTag& tag = rival.tags().at(epc);
    if (!tag.placed) continue;
    const Eigen::Vector3d in_L = tag.state.p_W_X - p_L_X;
    const Eigen::Vector3d in_C = rival.T_L_C(pose).inverse() * tag.state.p_W_X - p_C_X;
    others.spread_L += weights[r + 1] * in_L * in_L.transpose();
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
  const PrincipalAxes shape = principal_axes(places);
  if (!shape.is_line()) return std::nullopt;
  const Eigen::Vector3d along = shape.line(), d = p - shape.centre;
  const Eigen::Vector3d radius = d - along.dot(d) * along, tangent = along.cross(radius);
  return Eigen::Matrix3d(1.5 * radius * radius.transpose() + 0.5 * tangent * tangent.transpose());
}

Accuracy accuracy_of(const JointSegment& segment, const SegmentTag& tag, double length_m) {
  Accuracy a;
  const Eigen::Vector3d& p_L_X = tag.state.p_W_X;
  std::vector<Eigen::Vector3d> antennas;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& chain : tag.chains) {
    std::size_t previous = antennas.size();
    const std::size_t first = previous;
    for (const SegmentTag::Read& r : chain) {
      antennas.push_back(segment.antenna_L(r));
      mean += (p_L_X - antennas.back()).normalized();
      // Travel shorter than about two correlation lengths brings no new structured error.
      const double moved = antennas.size() - 1 == first ? 1e9 : (antennas.back() - antennas[previous]).norm();
      if (moved > 2.0 * length_m) {
        a.independent_reads += 1.0;
        previous = antennas.size() - 1;
      }
    }
  }
  for (const Eigen::Vector3d& p : antennas) {
    const double cosine = std::clamp((p_L_X - p).normalized().dot(mean.normalized()), -1.0, 1.0);
    a.bearing_sweep_rad = std::max(a.bearing_sweep_rad, 2.0 * std::acos(cosine));
  }
  a.hdop = horizontal_dilution(antennas, p_L_X).value;
  a.circle = circle_through(p_L_X, antennas);
  return a;
}

// The strength of the error comes from the tag's own residuals, so that the normalised error is Student's t, not a
// normal one: with nu degrees of freedom its variance is nu / (nu - 2) times as large.
double finite_sample(double independent_reads) {
  constexpr double kUnknowns = 4.0, kFewest = 4.0;
  const double nu = std::max(independent_reads - kUnknowns, kFewest);
  return nu / (nu - 2.0);
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

TagEstimate describe_tag(const JointSegment& segment, const Epc& epc, const SegmentTag& tag, DeviceTime now,
                         double camera_rotation_sigma_rad, const JointConfig& config) {
  TagEstimate e;
  e.time = now;
  e.epc = epc;
  e.segment = segment.ids().back();
  e.map_revision = segment.revision();
  e.reads = tag.reads;
  e.status = TagStatus::kTooFewReads;
  if (!tag.placed) return e;

  const Eigen::Vector3d& p_L_X = tag.state.p_W_X;
  const ClosestApproach closest = closest_approach(segment, p_L_X);
  const Rigid3 T_L_C = segment.T_L_C(closest.pose);
  e.segment = segment.id_of(closest.pose);
  e.closest_approach = closest.pose.time;
  e.p_C_X_m = T_L_C.inverse() * p_L_X;
  const OtherSolutions others = other_solutions(segment, epc, p_L_X, closest.pose);
  const bool undecided = ambiguous(tag, others.elsewhere);
  const Accuracy accuracy = accuracy_of(segment, tag, config.correlation_length_m);
  e.hdop = accuracy.hdop;
  e.bearing_sweep_rad = accuracy.bearing_sweep_rad;
  e.independent_reads = accuracy.independent_reads;
  const double t = finite_sample(accuracy.independent_reads);
  e.covariance_C_m2 = t * camera_relative_covariance(segment, tag, closest.pose) +
                      rotation_covariance(e.p_C_X_m, camera_rotation_sigma_rad) + others.spread_C;
  e.status = status_of(segment, tag, undecided, accuracy.circle.has_value(), e.covariance_C_m2, now, config);
  Eigen::Matrix3d in_L = t * tag.covariance.topLeftCorner<3, 3>() + others.spread_L +
                         rotation_covariance(p_L_X - T_L_C.t, camera_rotation_sigma_rad);

  const Anchor& anchor = segment.anchor();
  const Eigen::Matrix3d R_W_L = anchor.T_W_L.R.toRotationMatrix();
  e.p_W_X_m = anchor.T_W_L * p_L_X;
  const auto J = anchor.jacobian_at(e.p_W_X_m);
  const Eigen::Matrix3d of_anchor = J * anchor.covariance * J.transpose();
  const auto to_W = [&](const Eigen::Matrix3d& covariance_L) {
    return Eigen::Matrix3d(R_W_L * covariance_L * R_W_L.transpose() + of_anchor);
  };
  if (tag.shared_covariance.size() > 0)
    e.covariance_with_log_scale_m = R_W_L * tag.shared_covariance.block<3, 1>(0, SharedLayout::kLogScale);
  constexpr std::size_t kMaxHypotheses = 8;
  for (std::size_t i = 0; i < std::min(tag.modes.size(), kMaxHypotheses); ++i) {
    const TagMode& mode = tag.modes[i];
    constexpr double kWorthTelling = 0.005;
    const bool first = i == 0;  // the first one is the published position, refined since
    if (!first && mode.weight < kWorthTelling) break;
    e.hypotheses.push_back({first ? e.p_W_X_m : anchor.T_W_L * mode.tag.p_W_X,
                            to_W(first ? in_L : Eigen::Matrix3d(t * mode.covariance.topLeftCorner<3, 3>())),
                            mode.weight});
  }
  if (undecided) {
    // Who looks at the covariance alone must not take an undecided position for a good one.
    const Eigen::Matrix3d spread = accuracy.circle.value_or(spread_of_modes(tag)),
                          R_C_L = T_L_C.R.conjugate().toRotationMatrix();
    in_L += spread;
    e.covariance_C_m2 += R_C_L * spread * R_C_L.transpose();
  }
  e.covariance_m2 = to_W(in_L);
  return e;
}

// One of each per piece of the path.
std::vector<ScaleEstimate> describe_scales(const JointSegment& segment, DeviceTime now) {
  std::vector<ScaleEstimate> scales;
  for (std::size_t piece = 0; piece < segment.ids().size(); ++piece)
    scales.push_back({now, segment.ids()[piece], segment.scale_observable(),
                      segment.started() ? segment.scale_m_per_unit(piece) : 0.0,
                      segment.started() ? segment.log_scale_sigma(piece) : 0.0});
  return scales;
}

std::vector<Trajectory> describe_paths(const JointSegment& segment, DeviceTime now) {
  std::vector<Trajectory> paths;
  if (!segment.started()) return paths;
  for (const std::uint32_t id : segment.ids()) paths.push_back({now, id, segment.revision(), {}});
  for (const PathPose& pose : segment.path().poses())
    paths[segment.path().piece_of(pose.arc_V)].poses.push_back(
        {pose.time, segment.id_of(pose), segment.revision(), segment.T_W_C(pose), segment.pose_covariance_W(pose)});
  return paths;
}

}  // namespace

SegmentsDescription describe_segments(const std::vector<JointSegment>& segments, DeviceTime now,
                                      double camera_rotation_sigma_rad, const JointConfig& config) {
  SegmentsDescription all;
  for (const JointSegment& s : segments) {
    for (const auto& [epc, tag] : s.tags()) {
      TagEstimate e = describe_tag(s, epc, tag, now, camera_rotation_sigma_rad, config);
      const auto [place, first] = all.tags.try_emplace(epc, e);
      if (!first && says_more(e, place->second)) place->second = std::move(e);
    }
    for (const ScaleEstimate& scale : describe_scales(s, now)) all.scales.push_back(scale);
    for (Trajectory& path : describe_paths(s, now)) all.paths.push_back(std::move(path));
  }
  return all;
}

}  // namespace rfmvo
