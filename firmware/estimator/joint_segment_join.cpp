// JointSegment: what comes after it. The next window of the same odometry; or, the odometry having been lost, another
// segment: tags have names, and those that both saw say how the pieces of the path lie. From then on all are one
// problem.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"
#include "estimator/joint_segment.hpp"
#include "estimator/segment_alignment.hpp"

namespace rfmvo {
namespace {

std::vector<PlaceShare> places_of(const SegmentTag& tag) {
  std::vector<PlaceShare> places;
  for (const TagMode& mode : tag.modes) places.push_back({mode.tag.p_W_X, mode.weight});
  return places;
}

std::vector<SharedTag> shared_tags(const JointSegment& first, const JointSegment& second) {
  std::vector<SharedTag> shared;
  for (const auto& [epc, tag] : first.tags()) {
    const auto other = second.tags().find(epc);
    if (other == second.tags().end() || !tag.placed || !other->second.placed) continue;
    shared.push_back({places_of(tag), places_of(other->second)});
  }
  return shared;
}

}  // namespace

// The camera went on as it went in the last half second; how far it may have strayed grows with the time.
JointSegment::Expected JointSegment::expected_at(DeviceTime time) const {
  constexpr double kLookBack_s = 0.5, kAcceleration_m_s2 = 0.5, kTurn_rad_s = 0.3;
  const std::vector<PathPose>& poses = path_.poses();
  const PathPose& last = poses.back();
  const auto recent = std::find_if(poses.begin(), poses.end(),
                                   [&](const PathPose& p) { return (last.time - p.time).seconds() <= kLookBack_s; });
  const double back_s = (last.time - recent->time).seconds(), ahead_s = (time - last.time).seconds();
  Rigid3 T = T_L_C(last);
  if (back_s > 0.0) T.t += (T.t - T_L_C(*recent).t) / back_s * ahead_s;
  return {T, 0.1 + 0.5 * kAcceleration_m_s2 * ahead_s * ahead_s, 0.05 + kTurn_rad_s * ahead_s};
}

JointSegment JointSegment::after_loss(const CameraPose& first) const {
  constexpr double kUnknown_m = 100.0;
  const bool scaled = scale_observable();
  const Expected expected = expected_at(first.time);
  JointSegment later(config_, calibration_, first.segment,
                     anchor_.T_W_L * (scaled ? expected.T_L_C : T_L_C(path_.poses().back())));
  Anchor anchor = later.anchor_;
  anchor.covariance = pose_covariance_W(path_.poses().back());
  for (int i = 0; i < 3; ++i) {
    anchor.covariance(i, i) += std::pow(scaled ? expected.position_sigma_m : kUnknown_m, 2);
    anchor.covariance(3 + i, 3 + i) += std::pow(expected.rotation_sigma_rad, 2);
  }
  later.set_anchor(anchor);
  return later;
}

JointSegment JointSegment::following() const {
  JointSegment next(config_, calibration_, ids_.back(), T_W_C(path_.poses().back()));
  next.reference_frequency_hz_ = reference_frequency_hz_;
  return next;
}

void JointSegment::take_over(const JointSegment& before) {
  if (path_.empty()) return;
  const std::vector<PathPose>& poses = before.path_.poses();
  auto there = std::lower_bound(poses.begin(), poses.end(), path_.poses().front().time,
                                [](const PathPose& p, DeviceTime t) { return p.time < t; });
  if (there == poses.end()) --there;
  const Rigid3 T_L_C0 = T_L_C(path_.poses().front());
  anchor_ = {before.T_W_C(*there) * T_L_C0.inverse(), before.pose_covariance_W(*there)};
  revision_ = before.revision_;
  if (!before.started_) return;

  const KnotState knot = before.knot_at(there->arc_V);
  shared_ = before.shared_;
  shared_.log_scale += std::log(before.path_.pieces().back().joint.ratio * (1.0 + knot.log_scale_drift));
  shared_.knots.assign(1, {});
  knot_spacing_V_ = config_.joint.knot_spacing_m / std::exp(shared_.log_scale);
  structured_ = before.structured_;
  misreads_ = before.misreads_;
  set_drift(before.drift_factor_);
  const Rigid3 T_here_there = T_L_C0 * before.T_L_C(*there).inverse();
  for (auto& [epc, tag] : tags_) {
    const auto known = before.tags_.find(epc);
    if (known == before.tags_.end() || !known->second.placed) continue;
    tag.modes = known->second.modes;
    for (TagMode& mode : tag.modes) mode.tag.p_W_X = T_here_there * mode.tag.p_W_X;
    tag.state = tag.modes[0].tag;
  }
  evidence_margin_ = before.evidence_margin_;
  started_ = true;
}

// This path and then the other's, its tags and reads carried into the frame of this one.
void JointSegment::append(const JointSegment& later, const Rigid3& T_first_second) {
  const double unit_m = scale_m_per_unit();
  const PathJoint joint{later.scale_m_per_unit() / unit_m, T_first_second.R, T_first_second.t / unit_m};
  resize_knots();
  const std::size_t first_piece = path_.pieces().size();
  path_.append(later.path_, joint);
  ids_.insert(ids_.end(), later.ids_.begin(), later.ids_.end());

  // Corrections of the path, read off where this path's knots are.
  const double start_V = path_.pieces()[first_piece].arc_V;
  for (std::size_t p = first_piece; p < path_.pieces().size(); ++p)
    for (int k = 0; k < path_.knots_of(p, knot_spacing_V_); ++k) {
      const double arc_V = std::min(path_.pieces()[p].arc_V + k * knot_spacing_V_, path_.end_arc_V(p));
      KnotState knot = later.knot_at((arc_V - start_V) / joint.ratio);
      knot.path_correction_W = joint.R * knot.path_correction_W;
      knot.rotation_correction_W = joint.R * knot.rotation_correction_W;
      shared_.knots.push_back(knot);
    }

  const double later_s = (later.start_time_ - start_time_).seconds();
  for (const auto& [epc, other] : later.tags_) {
    SegmentTag& tag = tags_[epc];
    tag.chains.resize(calibration_.antennas.size());
    for (std::size_t p = 0; p < tag.chains.size(); ++p)
      for (SegmentTag::Read r : other.chains[p]) {
        ReadGeometry& g = r.read.geometry;
        g.n_W = joint * g.n_W;
        g.velocity_W = joint.ratio * (joint.R * g.velocity_W);
        g.R_W_C = joint.R.toRotationMatrix() * g.R_W_C;
        g.frequency_term_rad_m = wavenumber_rad_m(r.frequency_hz - reference_frequency_hz_);
        r.arc_V = start_V + joint.ratio * r.arc_V;
        r.time_s += later_s;
        tag.chains[p].push_back(r);
      }
    for (TagMode mode : other.modes) {
      mode.tag.p_W_X = T_first_second * mode.tag.p_W_X;
      tag.modes.push_back(mode);
    }
    if (!tag.placed && other.placed) {
      tag.state = other.state;
      tag.state.p_W_X = T_first_second * other.state.p_W_X;
      tag.placed = true;
    }
    tag.reads += other.reads;
    tag.last_read = std::max(tag.last_read, other.last_read);
    tag.reads_at_modes = tag.reads_at_places = 0;
  }
  rejected_ += later.rejected_;
  covariance_ = {};
  rivals_.clear();
}

// How the later one may lie. The tags are laid over each other from where the camera was expected, which is held to
// more or less: mostly the camera did go on as it went, and tags seen at the very end of a segment have several places.
std::vector<Rigid3> JointSegment::alignments_with(const JointSegment& later) const {
  constexpr std::array<double, 3> kTrust{0.1, 0.3, 1.0};
  constexpr std::array<double, 2> kTolerances_m{0.10, 0.25};  // a few sigmas of a tag in a map of its own
  const PathPose& first = later.path_.poses().front();
  const Expected expected = expected_at(first.time);
  const Rigid3 T_later_C = later.T_L_C(first);
  const std::vector<SharedTag> shared = shared_tags(*this, later);
  std::vector<Rigid3> found{expected.T_L_C * T_later_C.inverse()};
  for (const double trust : kTrust)
    for (const double tolerance_m : kTolerances_m) {
      const ExpectedStart start{expected.T_L_C, T_later_C, trust * expected.position_sigma_m,
                                trust * expected.rotation_sigma_rad};
      if (const auto alignment = align_maps(shared, start, tolerance_m)) found.push_back(alignment->T_first_second);
    }
  return found;
}

std::optional<JointSegment> JointSegment::joined(const JointSegment& later, Depth depth) const {
  if (!scale_observable() || !later.scale_observable()) return std::nullopt;
  std::optional<JointSegment> best;
  for (const Rigid3& T_first_second : alignments_with(later)) {
    JointSegment both = *this;
    both.append(later, T_first_second);
    both.iterate(Depth::kLook);
    both.evidence_ = both.total_evidence();
    if (!best || both.evidence_ > best->evidence_) best = std::move(both);
  }
  best->iterate(depth);
  ++best->revision_;
  // One map for two explains the same reads with fewer unknowns, if it is one: else a tag was moved or the maps lie
  // on each other by chance.
  if (best->total_evidence() < total_evidence() + later.total_evidence()) return std::nullopt;
  return best;
}

}  // namespace rfmvo
