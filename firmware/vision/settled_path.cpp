#include "vision/settled_path.hpp"

#include <algorithm>

namespace rfmvo {
namespace {

// The fraction f of the way from one pose to another that is near.
ViewPose between(const ViewPose& a, const ViewPose& b, double f) {
  const UnscaledPose mixed = interpolate(to_unscaled(a), to_unscaled(b), f);
  return {mixed.R_V_C.conjugate(), -(mixed.R_V_C.conjugate() * mixed.p_V_C)};
}

}  // namespace

void SettledPath::add(DeviceTime time, const ViewPose& T_C_V, const Map& map) {
  const Keyframe& newest = map.keyframes.back();
  pending_.push_back({time, T_C_V, {newest.id, relative(T_C_V, newest.T_C_V)}, std::nullopt});
}

void SettledPath::tie(const Map& map, const ViewPose& T_C_V) {
  const std::int64_t id = map.keyframes.back().id;
  for (auto it = pending_.rbegin(); it != pending_.rend() && !it->after && it->before.keyframe < id; ++it) {
    it->after = Tie{id, relative(it->T_C_V, T_C_V)};
  }
}

ViewPose SettledPath::now_at(const Pending& pending, const Map& map) {
  const Keyframe* a = map.find(pending.before.keyframe);
  if (!a) return pending.T_C_V;
  const ViewPose from_before = composed(pending.before.T_C_K, a->T_C_V);
  const Keyframe* b = pending.after ? map.find(pending.after->keyframe) : nullptr;
  if (!b || b->time <= a->time) return from_before;
  const double f = std::clamp((pending.time - a->time).seconds() / (b->time - a->time).seconds(), 0.0, 1.0);
  return between(from_before, composed(pending.after->T_C_K, b->T_C_V), f);
}

SettledPose SettledPath::take(const Map& map) {
  const Pending& first = pending_.front();
  SettledPose settled{first.time, 0, to_unscaled(now_at(first, map))};
  pending_.pop_front();
  return settled;
}

std::vector<SettledPose> SettledPath::due(DeviceTime now, const Map& map) {
  std::vector<SettledPose> result;
  while (!pending_.empty() && now - pending_.front().time >= kSettleLag) result.push_back(take(map));
  return result;
}

std::vector<SettledPose> SettledPath::rest(const Map& map) {
  std::vector<SettledPose> result;
  while (!pending_.empty()) result.push_back(take(map));
  return result;
}

}  // namespace rfmvo
