// One tag's reads as independent, unit-variance equations: prediction, wrapping, pi-flip decision,
// conditioning on the chain's last reads, robust weight. docs/estimator.md, sections 2 and 4.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimator/joint_problem.hpp"
#include "estimator/phase_error_model.hpp"

namespace rfmvo {

// A whitened row: residual and its derivatives. Knot columns are a short run of knots, since only
// neighbouring reads mix.
struct WhitenedRow {
  static constexpr int kMaxKnots = 6;
  static constexpr int kGlobals = 7;  // log scale, time offset, port offset, electrical length, lever arm (3)
  double residual = 0.0;              // (measured - predicted), in sigmas
  double weight = 1.0;                // robust, 0..1
  bool flipped = false;
  int port = 0;
  Eigen::Vector4d tag = Eigen::Vector4d::Zero();  // position (3), offset
  Eigen::Matrix<double, kGlobals, 1> globals = Eigen::Matrix<double, kGlobals, 1>::Zero();
  int first_knot = 0, knots = 0;
  std::array<Eigen::Matrix<double, 6, 1>, kMaxKnots> knot;  // path correction (3), rotation correction (3)
};

struct WhitenedTag {
  std::vector<WhitenedRow> rows;
  double cost = 0.0;          // sum of robust losses (1/2 residual^2 for inliers) + flip penalties
  double log_variance = 0.0;  // sum of ln(conditional variance)
  double inliers = 0.0;

  // Work space: rows before whitening.
  struct Raw {
    double residual = 0.0;   // measured - predicted, wrapped
    double unwrapped = 0.0;  // the same continuous along the chain, pi flip removed
    Eigen::Vector4d tag;
    Eigen::Matrix<double, WhitenedRow::kGlobals, 1> globals;
    Eigen::Matrix<double, 6, 1> gradient_knot;
    bool usable = true;
  };
  std::vector<Raw> raws;
};

// How each read of a tag leans on those before it, while all of them can be relied on. Depends on no
// state: computed once per solution.
struct ChainConditioning {
  struct Read {
    std::array<std::size_t, Conditioning::kMaxNeighbours> neighbour{};
    std::size_t count = 0;
    Eigen::Matrix4d correlation = Eigen::Matrix4d::Identity();  // of this read (0) and its neighbours, by strength
    Eigen::Vector4d white_rad2 = Eigen::Vector4d::Zero();
    Conditioning given;
  };
  std::vector<Read> reads;
  double structured_sigma_rad = 0.0;
  StructuredShape shape;
};
[[nodiscard]] ChainConditioning condition_chains(const std::vector<JointRead>& reads, double structured_sigma_rad,
                                                 const StructuredShape& shape);

// The same chains, should the structured error be stronger or weaker.
void set_strength(double structured_sigma_rad, ChainConditioning& conditioning);

enum class Derivatives { kNone, kTag, kAll };

// out.raws: prediction and derivatives of every read. `rows` and `raws` of out are reused: no
// allocation in steady state.
void predict_rows(const std::vector<JointRead>& reads, const JointState& state, const TagState& tag,
                  Derivatives derivatives, WhitenedTag& out);
// From out.raws, whoever made them, everything else of out.
void whiten_rows(const std::vector<JointRead>& reads, const JointProblem& problem,
                 const ChainConditioning& conditioning, Derivatives derivatives, WhitenedTag& out);

// Both, and the conditioning too.
void whiten(const std::vector<JointRead>& reads, const JointProblem& problem, const JointState& state,
            const TagState& tag, bool with_jacobian, WhitenedTag& out);

}  // namespace rfmvo
