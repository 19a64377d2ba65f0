#include "bound/columns.hpp"

#include <algorithm>
#include <limits>

#include "base/assert.hpp"

namespace rfmvo::bound {
namespace {

// Weak enough to say nothing, strong enough to keep the information invertible where the reads say nothing.
// An offset trades with a tag's range at 39 rad/m, so its prior must be wide enough for 100 m.
constexpr double kTagPrior_m = 100.0, kOffsetPrior_rad = 1e5, kScalePrior = 10.0;
constexpr int kPerPort = 4;            // length, lever arm
constexpr double kRateStep_s = 0.002;  // for velocities; the path is smooth over it
constexpr double kKnown = 1e-9;        // prior of what is known: far below anything that matters

}  // namespace

int Columns::add(int count, double sigma) {
  const int first = size();
  sigmas_.insert(sigmas_.end(), static_cast<std::size_t>(count), sigma);
  return first;
}

Columns::Columns(const World& world, const Settings& settings)
    : world_(world), settings_(settings), drift_(world, settings.knot_spacing_m) {
  RFMVO_ASSERT(world.frame_times_s.size() >= 2);
  const int tags = static_cast<int>(world.tags.size()), ports = static_cast<int>(world.lever_arms_C_m.size());
  tags_ = add(3 * tags, kTagPrior_m);
  // Only sums of a tag's and a port's offset are seen: the first port's is part of every tag's.
  offsets_ = add(settings.free_offsets ? tags * ports : tags + ports - 1, kOffsetPrior_rad);
  ports_ = size();
  for (int port = 0; port < ports; ++port) {
    add(1, settings.length_sigma_m);
    for (const double sigma_m : world.lever_arm_sigma_m)
      add(1, settings.known_lever_arms ? kKnown : std::max(sigma_m, kKnown));
  }
  if (!settings.known_path) add_path();
}

void Columns::add_path() {
  scale_ = add(1, kScalePrior);
  if (settings_.time_offset_sigma_s > 0.0) time_offset_ = add(1, settings_.time_offset_sigma_s);
  walks_ = size();
  for (const double sigma : drift_.sigmas()) add(1, std::max(sigma, kKnown));
  if (world_.drift.white_m <= 0.0) return;
  for (const Read& read : world_.reads) {
    add_white_pose(frame_before(read.t_s));
    add_white_pose(frame_before(read.t_s) + 1);
  }
  for (std::size_t tag = 0; tag < world_.tags.size(); ++tag) add_white_pose(closest_frame(tag));
}

// The first pose is the origin: it has no error.
void Columns::add_white_pose(std::size_t frame) {
  if (frame > 0 && !white_.contains(frame)) white_[frame] = add(3, world_.drift.white_m);
}

std::size_t Columns::frame_before(double t_s) const {
  const auto& times = world_.frame_times_s;
  const auto after = std::upper_bound(times.begin(), times.end(), t_s) - times.begin();
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - 1, 0, std::ssize(times) - 2));
}

std::size_t Columns::closest_frame(std::size_t tag) const {
  std::size_t best = 0;
  double best_m = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < world_.frame_times_s.size(); ++k) {
    const double distance_m = (world_.T_S_C(world_.frame_times_s[k]).t - world_.tags[tag].p_S_X_m).norm();
    if (distance_m < best_m) {
      best_m = distance_m;
      best = k;
    }
  }
  return best;
}

ReadPlace Columns::place_of(const Read& read) const {
  const Rigid3 T = world_.T_S_C(read.t_s);
  const Rigid3 before = world_.T_S_C(read.t_s - 0.5 * kRateStep_s), after = world_.T_S_C(read.t_s + 0.5 * kRateStep_s);
  ReadPlace place;
  place.p_S_C_m = T.t;
  place.travelled_m = T.t - world_.T_S_C(world_.frame_times_s.front()).t;
  place.R_S_C = T.R.toRotationMatrix();
  place.velocity_m_s = (after.t - before.t) / kRateStep_s;
  place.angular_velocity_rad_s = so3_log(after.R * before.R.conjugate()) / kRateStep_s;
  place.lever_arm_C_m = world_.lever_arms_C_m[read.port];
  place.p_S_X_m = world_.tags[read.tag].p_S_X_m;
  place.wavenumber_rad_m = 2.0 * kTwoPi * read.frequency_hz / kSpeedOfLight_m_s;
  place.frequency_term_rad_m =
      2.0 * kTwoPi * (read.frequency_hz - world_.reads.front().frequency_hz) / kSpeedOfLight_m_s;
  return place;
}

void Columns::append_offset(const Read& read, double derivative, SparseRow& row) const {
  const int tag = static_cast<int>(read.tag), port = static_cast<int>(read.port);
  if (settings_.free_offsets) {
    row.emplace_back(offsets_ + tag * static_cast<int>(world_.lever_arms_C_m.size()) + port, derivative);
    return;
  }
  row.emplace_back(offsets_ + tag, derivative);
  if (port > 0) row.emplace_back(offsets_ + static_cast<int>(world_.tags.size()) + port - 1, derivative);
}

void Columns::append_path(const Read& read, const Row& derivative, SparseRow& row) const {
  row.emplace_back(scale_, derivative[kLogScale]);
  if (time_offset_ >= 0) row.emplace_back(time_offset_, derivative[kTimeOffset]);
  const Eigen::RowVectorXd walks = derivative.segment<6>(kShift) * drift_.at(read.t_s);
  for (int i = 0; i < walks.size(); ++i) {
    if (walks[i] != 0.0) row.emplace_back(walks_ + i, walks[i]);
  }
  const std::size_t k = frame_before(read.t_s);
  const double a_s = world_.frame_times_s[k], b_s = world_.frame_times_s[k + 1];
  const double f = std::clamp((read.t_s - a_s) / (b_s - a_s), 0.0, 1.0);
  for (const auto& [frame, share] : {std::pair(k, 1.0 - f), std::pair(k + 1, f)}) {
    const auto found = white_.find(frame);
    if (found == white_.end()) continue;
    for (int i = 0; i < 3; ++i) row.emplace_back(found->second + i, share * derivative[kShift + i]);
  }
}

SparseRow Columns::of_read(const Read& read) const {
  const Row d = derivative(place_of(read));
  SparseRow row;
  for (int i = 0; i < 3; ++i) row.emplace_back(tags_ + 3 * static_cast<int>(read.tag) + i, d[kTagX + i]);
  append_offset(read, d[kOffset], row);
  const int port = ports_ + kPerPort * static_cast<int>(read.port);
  row.emplace_back(port, d[kLength]);
  for (int i = 0; i < 3; ++i) row.emplace_back(port + 1 + i, d[kLeverArm + i]);
  if (has_path()) append_path(read, d, row);
  return row;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> Columns::of_camera(std::size_t frame) const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, size());
  if (!has_path()) return rows;
  const double t_s = world_.frame_times_s[frame];
  rows.block<3, 1>(0, scale_) = world_.T_S_C(t_s).t - world_.T_S_C(world_.frame_times_s.front()).t;
  rows.middleCols(walks_, drift_.sigmas().size()) = drift_.at(t_s);
  if (const auto found = white_.find(frame); found != white_.end())
    rows.block<3, 3>(0, found->second) = Eigen::Matrix3d::Identity();
  return rows;
}

// p = R^T (x - c), so dp = R^T (dx - dc - dtheta x (x - c)).
Eigen::MatrixXd Columns::of_tag_in_camera(std::size_t tag, std::size_t frame) const {
  const Rigid3 T = world_.T_S_C(world_.frame_times_s[frame]);
  const auto camera = of_camera(frame);
  Eigen::MatrixXd rows = -camera.topRows<3>() + skew(world_.tags[tag].p_S_X_m - T.t) * camera.bottomRows<3>();
  rows.middleCols<3>(tags_ + 3 * static_cast<int>(tag)) += Eigen::Matrix3d::Identity();
  return T.R.toRotationMatrix().transpose() * rows;
}

// A rotation about the centre moves every pose across its own arm, so only the part along the arms is scale.
Eigen::RowVectorXd Columns::of_path_scale() const {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size());
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  const double count = static_cast<double>(world_.frame_times_s.size());
  for (const double t_s : world_.frame_times_s) centre_m += world_.T_S_C(t_s).t / count;
  double spread_m2 = 0.0;
  for (std::size_t k = 0; k < world_.frame_times_s.size(); ++k) {
    const Eigen::Vector3d arm_m = world_.T_S_C(world_.frame_times_s[k]).t - centre_m;
    spread_m2 += arm_m.squaredNorm();
    row += arm_m.transpose() * of_camera(k).topRows<3>();
  }
  constexpr double kNoTravel_m2 = 1e-12;
  if (spread_m2 < kNoTravel_m2) return Eigen::RowVectorXd::Zero(size());
  return row / spread_m2;
}

}  // namespace rfmvo::bound
