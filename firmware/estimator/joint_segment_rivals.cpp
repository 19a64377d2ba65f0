// JointSegment: solutions that explain the reads about as well. One solution's covariance knows nothing of another
// set of cycles, in which the scale, the port offsets and a few tags are wrong together.
#include <algorithm>
#include <cmath>

#include "estimator/joint_segment.hpp"

namespace rfmvo {
namespace {

// Mean distance between the positions of one tag in two solutions, over the tags of both, m.
double apart_m(const JointSegment& a, const JointSegment& b) {
  double sum = 0.0, count = 0.0;
  for (const auto& [epc, tag] : a.tags()) {
    const SegmentTag& other = b.tags().at(epc);
    if (!tag.placed || !other.placed) continue;
    sum += (tag.state.p_W_X - other.state.p_W_X).norm();
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

// Another start: in full if it may be as good. The likeliest one in any case: what was found while reads came in may
// have kept a tag or two at places that the first reads favoured.
void JointSegment::try_starts(std::vector<JointSegment>& solutions) const {
  constexpr double kWorthATry = 60.0;  // nats below the best start
  constexpr double kAsDeep = 30.0;     // after a first look
  constexpr int kMaxRivals = 2;        // with about this scale, and as many with another
  JointSegment seeker = *this;
  // A start that trusts reads which a first solution has found to be garbled is led astray by them.
  const Misreads least = misreads_configured();
  const std::vector<StartCandidate> starts =
      seeker.search_starts({std::max(least.flips, misreads_.flips), std::max(least.outliers, misreads_.outliers)});
  int near = 0, far = 0;
  for (const StartCandidate& c : starts) {
    if (c.evidence < starts[0].evidence - kWorthATry) break;
    int& tried = std::abs(c.state.log_scale - shared_.log_scale) > kMaterialLogScale ? far : near;
    if (tried++ >= kMaxRivals) continue;
    JointSegment rival = *this;
    rival.adopt(c);
    rival.iterate(Depth::kLook);
    if (near + far == 1 || rival.total_evidence() > solutions[0].evidence_ - kAsDeep) rival.iterate(Depth::kFull);
    rival.evidence_ = rival.total_evidence();
    solutions.push_back(std::move(rival));
  }
}

// The same solution with a port's offset a little aside, and every tag placed anew: lobes move with it.
void JointSegment::try_offsets(std::vector<JointSegment>& solutions) const {
  constexpr double kAside_rad = 0.9;
  for (std::size_t p = 1; p < shared_.ports.size(); ++p)
    for (const double aside_rad : {-kAside_rad, kAside_rad}) {
      JointSegment rival = *this;
      rival.shared_.ports[p].offset_rad += aside_rad;
      rival.covariance_ = {};
      rival.iterate(Depth::kAside);
      rival.evidence_ = rival.total_evidence();
      solutions.push_back(std::move(rival));
    }
}

void JointSegment::consider_rivals() {
  rivals_.clear();
  evidence_ = total_evidence();
  std::vector<JointSegment> solutions{*this};
  try_starts(solutions);
  const auto better = [](const JointSegment& a, const JointSegment& b) { return a.evidence_ > b.evidence_; };
  std::stable_sort(solutions.begin(), solutions.end(), better);
  const JointSegment best = solutions[0];
  best.try_offsets(solutions);
  std::stable_sort(solutions.begin(), solutions.end(), better);

  const auto revision = revision_;
  *this = solutions[0];
  revision_ = revision;
  constexpr double kSameSolution_m = 0.02, kHopeless = 12.0;
  double second = 0.0;
  for (JointSegment& s : solutions) {
    if (std::abs(s.shared_.log_scale - shared_.log_scale) > kMaterialLogScale) second = std::max(second, s.evidence_);
    const auto known = [&](const JointSegment& r) { return apart_m(r, s) < kSameSolution_m; };
    if (s.evidence_ < evidence_ - kHopeless || known(*this) || std::any_of(rivals_.begin(), rivals_.end(), known))
      continue;
    rivals_.push_back(std::move(s));
  }
  evidence_margin_ = evidence_ - second;
}

std::vector<double> JointSegment::weights() const {
  std::vector<double> weights{1.0};
  for (const JointSegment& r : rivals_) weights.push_back(std::exp(r.evidence_ - evidence_));
  double sum = 0.0;
  for (const double w : weights) sum += w;
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace rfmvo
