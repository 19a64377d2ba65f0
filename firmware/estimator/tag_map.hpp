// What is known of every tag that was ever read, from windows of the path that are closed: a few hundred bytes a
// tag, however long the drive. What a later window finds is compared with it.
#pragma once

#include <map>
#include <vector>

#include "estimator/estimate.hpp"

namespace rfmvo {

class TagMap {
 public:
  explicit TagMap(double stale_after_s) : stale_after_s_(stale_after_s) {}

  // A window is closed: its last word on a tag, last read at `last_read`.
  void keep(const TagEstimate& estimate, DeviceTime last_read);

  // What holds now, given what is kept and what an open window (nullptr: none that has read the tag) says: the more
  // certain of the two. Where both are sure of different places, the tag was moved: the newer one, as kMoved.
  [[nodiscard]] TagEstimate best(const Epc& epc, const TagEstimate* open, DeviceTime now) const;

  [[nodiscard]] std::vector<Epc> tags() const;

 private:
  struct Kept {
    TagEstimate estimate;
    DeviceTime last_read;
  };
  double stale_after_s_;
  std::map<Epc, Kept> kept_;
};

// Of two estimates of one tag the one that says more: a position before none, then the smaller covariance.
[[nodiscard]] bool says_more(const TagEstimate& a, const TagEstimate& b);

// Both claim one place, and not the same: beyond what 1 in 10,000 unmoved tags shows, and more than half a wavelength.
[[nodiscard]] bool contradict(const TagEstimate& a, const TagEstimate& b);

}  // namespace rfmvo
