// The first map of a segment, from a handful of views with parallax. Standstill and pure rotation
// never give one.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vision/bundle_adjustment.hpp"
#include "vision/map.hpp"
#include "vision/two_view.hpp"

namespace rfmvo {

struct InitialiserOptions {
  double focal_px = 500.0;
  double gate_px = 2.0;
  double min_parallax_rad = 0.0175;
};

class Initialiser {
 public:
  explicit Initialiser(const InitialiserOptions& options) : options_(options) {}

  void restart() { views_.clear(); }

  // The next frame; tracks are sorted by landmark. With a value, the last key frame of the map is this
  // frame, V is its camera frame, and the median depth seen from it is 1.
  [[nodiscard]] std::optional<Map> on(DeviceTime time, const Pyramid& pyramid, std::span<const Track> tracks);

 private:
  struct View {
    DeviceTime time;
    Pyramid pyramid;
    std::vector<Track> tracks;
  };
  struct Pair {
    Track first, second;
  };
  struct Candidate {
    Map map;
    double cost_per_observation_px2 = 0.0;
    double parallax_rad = 0.0;  // median between the first and the last view
    int points = 0;
  };

  [[nodiscard]] static std::vector<Pair> common(const View& view, std::span<const Track> tracks);
  [[nodiscard]] static double median_flow_rad(const std::vector<Pair>& pairs);
  [[nodiscard]] std::optional<Map> attempt(const std::vector<Pair>& pairs, const View& current);
  [[nodiscard]] std::optional<Candidate> build(const TwoViewHypothesis& hypothesis, const std::vector<Pair>& pairs,
                                               const View& current) const;
  void add_views(const std::vector<const View*>& views, const std::vector<std::int64_t>& ids, const ViewPose& last,
                 BundleProblem& bundle) const;
  void locate(const std::vector<std::int64_t>& ids, Candidate& candidate) const;
  [[nodiscard]] static bool is_clear(const std::vector<Candidate>& candidates);
  void remember(View view);

  InitialiserOptions options_;
  std::vector<View> views_;  // the reference first
};

}  // namespace rfmvo
