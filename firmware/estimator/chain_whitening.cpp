#include "estimator/chain_whitening.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/phase_error_model.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

// Reads farther back than this share no structured error (correlation below 0.02 at 5.7 lengths).
constexpr double kMaxNeighbourLengths = 5.7;
constexpr double kOutlierWeight = 0.2;  // below: not used to predict its followers

using Raw = WhitenedTag::Raw;

using Lean = ChainConditioning::Read;

// The last reads of the same chain, near enough to share the structured error; `usable` says which to skip.
template <class Usable>
Lean neighbours_of(std::size_t i, const std::vector<JointRead>& reads, const StructuredShape& shape,
                   const Usable& usable) {
  const double length_m = shape.long_share > 0.0 ? std::max(shape.length_m, kLongLength_m) : shape.length_m;
  Lean n;
  const int last_knot = reads[i].knot + 1;
  for (std::size_t j = i; j-- > 0 && n.count < Conditioning::kMaxNeighbours;) {
    if (reads[j].port != reads[i].port) break;
    if ((reads[i].p_W_A - reads[j].p_W_A).norm() > kMaxNeighbourLengths * length_m) break;
    if (last_knot - reads[j].knot + 1 > WhitenedRow::kMaxKnots) break;
    if (usable(j)) n.neighbour[n.count++] = j;
  }
  return n;
}

void condition(std::size_t i, const std::vector<JointRead>& reads, double sigma_rad, const StructuredShape& shape,
               Lean& n) {
  const auto at = [&](std::size_t k) -> const JointRead& { return reads[k == 0 ? i : n.neighbour[k - 1]]; };
  Eigen::Vector4d strength;
  for (std::size_t a = 0; a <= n.count; ++a) {
    const auto r = static_cast<Eigen::Index>(a);
    n.white_rad2[r] = at(a).white_rad2;
    strength[r] = relative_strength(at(a).fade_db, shape);
    n.correlation(r, r) = strength[r] * strength[r];
    for (std::size_t b = 0; b < a; ++b) {
      const auto c = static_cast<Eigen::Index>(b);
      n.correlation(r, c) = n.correlation(c, r) =
          strength[r] * strength[c] * structured_correlation((at(a).p_W_A - at(b).p_W_A).norm(), shape);
    }
  }
  n.given = condition_on_correlated(n.count, n.correlation, n.white_rad2, sigma_rad);
}

void add_scaled(WhitenedRow& row, const Raw& raw, const JointRead& read, double factor) {
  row.globals += factor * raw.globals;
  const auto k = static_cast<std::size_t>(read.knot - row.first_knot);
  row.knot[k] += factor * (1.0 - read.knot_fraction) * raw.gradient_knot;
  row.knot[k + 1] += factor * read.knot_fraction * raw.gradient_knot;
}

// A reader that turned one phase by pi turns the next ones of the same tag and port, too: bursts. Whether it does is a
// Markov chain of two states along the chain of reads; this is the probability that it does now, given the past.
class FlipBelief {
 public:
  explicit FlipBelief(double share) : enter_(share * (1.0 - kStay) / (1.0 - share)), share_(share), flipped_(share) {}
  void restart() { flipped_ = share_; }
  [[nodiscard]] double flipped() const { return flipped_; }
  void advance(double flipped_given_read) {
    flipped_ = flipped_given_read * kStay + (1.0 - flipped_given_read) * enter_;
  }

 private:
  static constexpr double kStay = 0.75;  // four reads a burst; real ones are of a few (DESIGN 2.8)
  double enter_, share_, flipped_;
};

// What one read may be: as modelled, flipped by pi, or (multipath at its worst, a stray reader) any
// phase at all. -ln of the mixture, relative to the first component's peak; weight = probability of
// being a measurement of this geometry at all.
struct Judgement {
  double innovation = 0.0;  // of the likelier of the two, rad
  bool flipped = false;
  double cost = 0.0, weight = 1.0;
  double flip_probability = 0.0;  // now that the read is known
};
Judgement judge(double innovation, double sigma_rad, double flip_probability, double outlier_probability) {
  const double other = wrap_rad(innovation + kPi);
  const double as_is = (1.0 - flip_probability) * std::exp(-0.5 * std::pow(innovation / sigma_rad, 2));
  const double flip = flip_probability * std::exp(-0.5 * std::pow(other / sigma_rad, 2));
  const double any = outlier_probability * sigma_rad / std::sqrt(kTwoPi);  // uniform on the circle
  const double measured = 1.0 - outlier_probability, sum = measured * (as_is + flip);
  const bool flipped = flip > as_is;
  return {flipped ? other : innovation, flipped, -std::log(sum + any), sum / (sum + any),
          (measured * flip + flip_probability * any) / (sum + any)};
}

}  // namespace

ReadStates states_at(const JointRead& read, const JointState& state, const TagState& tag) {
  const PortState& port = state.ports[static_cast<std::size_t>(read.port)];
  const KnotState& a = state.knots[static_cast<std::size_t>(read.knot)];
  const KnotState& b = state.knots[static_cast<std::size_t>(read.knot) + 1];
  const double f = read.knot_fraction;
  return {.log_scale = state.log_scale,
          .time_offset_s = state.time_offset_s,
          .port_offset_rad = port.offset_rad,
          .electrical_length_m = port.electrical_length_m,
          .lever_arm_C = port.lever_arm_C,
          .path_correction_W = (1.0 - f) * a.path_correction_W + f * b.path_correction_W,
          .rotation_correction_W = (1.0 - f) * a.rotation_correction_W + f * b.rotation_correction_W,
          .p_W_X = tag.p_W_X,
          .tag_offset_rad = tag.offset_rad};
}

ChainConditioning condition_chains(const std::vector<JointRead>& reads, double structured_sigma_rad,
                                   const StructuredShape& shape) {
  ChainConditioning c{{}, structured_sigma_rad, shape};
  c.reads.reserve(reads.size());
  for (std::size_t i = 0; i < reads.size(); ++i) {
    c.reads.push_back(neighbours_of(i, reads, shape, [](std::size_t) { return true; }));
    condition(i, reads, structured_sigma_rad, shape, c.reads.back());
  }
  return c;
}

void set_strength(double structured_sigma_rad, ChainConditioning& conditioning) {
  conditioning.structured_sigma_rad = structured_sigma_rad;
  for (Lean& n : conditioning.reads)
    n.given = condition_on_correlated(n.count, n.correlation, n.white_rad2, structured_sigma_rad);
}

void predict_rows(const std::vector<JointRead>& reads, const JointState& state, const TagState& tag,
                  Derivatives derivatives, WhitenedTag& out) {
  out.raws.resize(reads.size());
  for (std::size_t i = 0; i < reads.size(); ++i) {
    Raw& raw = out.raws[i];
    const ReadStates states = states_at(reads[i], state, tag);
    if (derivatives == Derivatives::kNone) {
      raw.residual = wrap_rad(reads[i].phase_rad - predicted_phase_rad(reads[i].geometry, states));
      continue;
    }
    const PredictedPhase p = predict_phase(reads[i].geometry, states);
    const PhaseJacobian& j = p.jacobian;
    raw.residual = wrap_rad(reads[i].phase_rad - p.phase_rad);
    raw.tag << j.tag_position, 1.0;
    raw.globals << j.log_scale, j.time_offset, 1.0, j.electrical_length, j.lever_arm;
    raw.gradient_knot << j.path_correction, j.rotation_correction;
  }
}

void whiten_rows(const std::vector<JointRead>& reads, const JointProblem& problem,
                 const ChainConditioning& conditioning, Derivatives derivatives, WhitenedTag& out) {
  std::vector<Raw>& raws = out.raws;
  out.rows.resize(reads.size());
  out.cost = out.log_variance = out.inliers = 0.0;
  FlipBelief flips(problem.flip_probability);
  for (std::size_t i = 0; i < reads.size(); ++i) {
    Raw& raw = raws[i];
    if (i > 0 && reads[i].port != reads[i - 1].port) flips.restart();
    const Lean* n = &conditioning.reads[i];
    Lean without_outliers;
    const auto usable = [&](std::size_t j) { return raws[j].usable; };
    if (!std::all_of(n->neighbour.begin(), n->neighbour.begin() + static_cast<std::ptrdiff_t>(n->count), usable)) {
      without_outliers = neighbours_of(i, reads, conditioning.shape, usable);
      condition(i, reads, conditioning.structured_sigma_rad, conditioning.shape, without_outliers);
      n = &without_outliers;
    }
    const Conditioning& c = n->given;
    double predicted = 0.0;
    for (std::size_t k = 0; k < n->count; ++k) predicted += c.weights[k] * raws[n->neighbour[k]].unwrapped;

    const double sigma_rad = std::sqrt(c.variance_rad2);
    const Judgement judgement =
        judge(wrap_rad(raw.residual - predicted), sigma_rad, flips.flipped(), problem.outlier_probability);
    flips.advance(judgement.flip_probability);
    raw.unwrapped = predicted + judgement.innovation;  // followers are predicted well
    raw.usable = judgement.weight > kOutlierWeight;
    out.cost += judgement.cost;
    out.log_variance += std::log(c.variance_rad2);
    out.inliers += judgement.weight;
    const double inverse_sigma = 1.0 / sigma_rad;
    WhitenedRow& row = out.rows[i];
    row.port = reads[i].port;
    row.residual = judgement.innovation * inverse_sigma;
    row.weight = judgement.weight;
    row.flipped = judgement.flipped;
    if (derivatives == Derivatives::kNone) continue;
    row.tag = inverse_sigma * raw.tag;
    for (std::size_t k = 0; k < n->count; ++k) row.tag -= c.weights[k] * inverse_sigma * raws[n->neighbour[k]].tag;
    if (derivatives == Derivatives::kTag) continue;

    row.globals.setZero();
    row.first_knot = reads[i].knot;
    for (std::size_t k = 0; k < n->count; ++k) row.first_knot = std::min(row.first_knot, reads[n->neighbour[k]].knot);
    row.knots = reads[i].knot + 2 - row.first_knot;
    for (int k = 0; k < row.knots; ++k) row.knot[static_cast<std::size_t>(k)].setZero();
    add_scaled(row, raw, reads[i], inverse_sigma);
    for (std::size_t k = 0; k < n->count; ++k)
      add_scaled(row, raws[n->neighbour[k]], reads[n->neighbour[k]], -c.weights[k] * inverse_sigma);
  }
}

void whiten(const std::vector<JointRead>& reads, const JointProblem& problem, const JointState& state,
            const TagState& tag, bool with_jacobian, WhitenedTag& out) {
  const Derivatives derivatives = with_jacobian ? Derivatives::kAll : Derivatives::kNone;
  predict_rows(reads, state, tag, derivatives, out);
  whiten_rows(reads, problem, condition_chains(reads, tag.structured_sigma_rad, problem.structured), derivatives, out);
}

}  // namespace rfmvo
