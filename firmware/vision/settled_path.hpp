// Poses as the bundle adjustment leaves them, a fixed time after they were made.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "vision/map.hpp"

namespace rfmvo {

struct SettledPose {
  DeviceTime time;
  std::uint32_t segment = 0;  // not known to SettledPath
  UnscaledPose T_V_C;
};

// Every pose is tied to the key frames before and after it; when these move, it moves with them.
class SettledPath {
 public:
  // A live pose; the key frame before it is the map's newest.
  void add(DeviceTime time, const ViewPose& T_C_V, const Map& map);
  // The map's newest key frame has just been made at this live pose; nothing has been adjusted since.
  void tie(const Map& map, const ViewPose& T_C_V);
  // Poses that are kSettleLag old by now, oldest first; they leave.
  [[nodiscard]] std::vector<SettledPose> due(DeviceTime now, const Map& map);
  // All that are left: the segment has ended.
  [[nodiscard]] std::vector<SettledPose> rest(const Map& map);

  static constexpr Duration kSettleLag{2'000'000'000};  // 60 views at 30 Hz

 private:
  struct Tie {
    std::int64_t keyframe = 0;
    ViewPose T_C_K;
  };
  struct Pending {
    DeviceTime time;
    ViewPose T_C_V;
    Tie before;
    std::optional<Tie> after;
  };
  [[nodiscard]] static ViewPose now_at(const Pending& pending, const Map& map);
  [[nodiscard]] SettledPose take(const Map& map);

  std::deque<Pending> pending_;
};

}  // namespace rfmvo
