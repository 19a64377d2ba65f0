#include <gtest/gtest.h>

#include <numeric>

#include "estimator/chain_whitening.hpp"
#include "estimator/joint_solver.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::make_world;
using joint_scene::World;

constexpr double kLength_m = 0.058;

// Reads of one tag by one port along a slow line, with errors drawn from the model.
struct Chain {
  World world;
  std::vector<Eigen::Vector3d> positions;
  std::vector<JointRead>& reads() { return world.problem.reads[0]; }
  const TagState& tag() const { return world.truth.tags[0]; }
  WhitenedTag whitened(bool with_jacobian = false) {
    WhitenedTag out;
    whiten(reads(), world.problem, world.truth, tag(), with_jacobian, out);
    return out;
  }
};

Chain straight_chain(int reads, double spacing_m, double white_rad2) {
  Chain chain;
  chain.world = make_world(1, 1, 1.0);
  chain.world.problem.structured.length_m = kLength_m;
  chain.world.truth.tags[0].structured_sigma_rad = 0.3;
  const JointRead first = chain.reads()[0];
  chain.reads().clear();
  const Eigen::Vector3d lever = first.geometry.R_W_C * chain.world.truth.ports[0].lever_arm_C;
  for (int i = 0; i < reads; ++i) {
    JointRead read = first;
    read.geometry.n_W = Eigen::Vector3d(spacing_m * i, 0.0, 0.0);
    read.p_W_A = read.geometry.n_W + lever;
    read.phase_rad = read.geometry.wavenumber_rad_m * (read.p_W_A - chain.tag().p_W_X).norm() + chain.tag().offset_rad +
                     read.geometry.frequency_term_rad_m * chain.world.truth.ports[0].electrical_length_m;
    read.knot = static_cast<int>(spacing_m * i / 0.75);
    read.knot_fraction = spacing_m * i / 0.75 - read.knot;
    read.white_rad2 = white_rad2;
    chain.reads().push_back(read);
    chain.positions.push_back(read.p_W_A);
  }
  return chain;
}

Eigen::VectorXd add_errors(Chain& chain, std::mt19937& random) {
  const Eigen::MatrixXd K = joint_scene::error_covariance(chain.positions, chain.tag().structured_sigma_rad, kLength_m,
                                                          chain.reads()[0].white_rad2);
  std::normal_distribution<double> normal;
  Eigen::VectorXd e(K.rows());
  for (double& x : e) x = normal(random);
  e = (K.llt().matrixL() * e).eval();
  for (std::size_t i = 0; i < chain.reads().size(); ++i)
    chain.reads()[i].phase_rad =
        std::remainder(chain.reads()[i].phase_rad + e[static_cast<Eigen::Index>(i)], 2.0 * joint_scene::kPi);
  return e;
}

TEST(ChainWhitening, ExactPhasesLeaveNoResidual) {
  World world = make_world(5, 30, 1.7);
  WhitenedTag out;
  for (std::size_t t = 0; t < 5; ++t) {
    whiten(world.problem.reads[t], world.problem, world.truth, world.truth.tags[t], false, out);
    for (const WhitenedRow& row : out.rows) EXPECT_NEAR(row.residual, 0.0, 1e-10);  // 100 rad to 1e-14, over 0.05
  }
}

TEST(ChainWhitening, MakesErrorsOfTheModelWhiteWithUnitVariance) {
  std::mt19937 random(31);
  constexpr int kChains = 200, kReads = 60;
  double sum = 0.0, squares = 0.0;
  std::array<double, 4> lagged{};
  for (int n = 0; n < kChains; ++n) {
    Chain chain = straight_chain(kReads, 0.015, 0.022 * 0.022);
    add_errors(chain, random);
    const WhitenedTag w = chain.whitened();
    for (std::size_t i = 0; i < w.rows.size(); ++i) {
      sum += w.rows[i].residual;
      squares += w.rows[i].residual * w.rows[i].residual;
      for (std::size_t lag = 1; lag <= 4 && lag <= i; ++lag)
        lagged[lag - 1] += w.rows[i].residual * w.rows[i - lag].residual;
    }
  }
  // 12000 samples: the mean has sigma 0.009, the variance 0.013, a correlation 0.009. Five sigmas; the correlations
  // may also keep a little of what three neighbours do not know (below 0.05 for this spacing and noise).
  constexpr double kSamples = kChains * kReads;
  EXPECT_NEAR(sum / kSamples, 0.0, 0.05);
  EXPECT_NEAR(squares / kSamples, 1.0, 0.065);
  for (const double product : lagged) EXPECT_NEAR(product / kSamples, 0.0, 0.095);
}

TEST(ChainWhitening, CostOfAShortChainIsTheGaussianLikelihood) {
  std::mt19937 random(32);
  for (int n = 0; n < 40; ++n) {
    const int count = 1 + n % 4;  // within the reach of three neighbours the chain rule is exact
    Chain chain = straight_chain(count, 0.02, 0.03 * 0.03);
    const Eigen::VectorXd e = add_errors(chain, random);
    const Eigen::MatrixXd K = joint_scene::error_covariance(chain.positions, 0.3, kLength_m, 0.03 * 0.03);
    const double dense = 0.5 * e.dot(K.inverse() * e) + 0.5 * std::log(K.determinant());
    const WhitenedTag w = chain.whitened();
    double squares = 0.0;
    for (const WhitenedRow& row : w.rows) squares += 0.5 * row.residual * row.residual;
    EXPECT_NEAR(squares + 0.5 * w.log_variance, dense, 1e-8);
    // The mixture adds -ln(1 - 1e-12), and 1e-12 / exp(-e^2 / 2) where e is large: at 4 sigmas 3e-9.
    EXPECT_NEAR(w.cost + 0.5 * w.log_variance, dense, 1e-7);
    EXPECT_NEAR(w.inliers, count, 1e-6);
  }
}

// -ln probability that a reader flips exactly these of 40 reads: a share of them in all, four in a burst on average.
double price_of_flips(const std::function<bool(std::size_t)>& flipped, double share) {
  constexpr double kStay = 0.75;
  const double enter = share * (1.0 - kStay) / (1.0 - share);
  double price = -std::log(flipped(0) ? share : 1.0 - share);
  for (std::size_t i = 1; i < 40; ++i) {
    const double flips_now = flipped(i - 1) ? kStay : enter;
    price -= std::log(flipped(i) ? flips_now : 1.0 - flips_now);
  }
  return price;
}

TEST(ChainWhitening, RecognisesAPiFlipAndSparesItsFollowers) {
  std::mt19937 random(33);
  for (const std::size_t flipped : {0UL, 1UL, 17UL, 39UL}) {
    Chain chain = straight_chain(40, 0.015, 0.022 * 0.022);
    chain.world.problem.flip_probability = 0.003;
    chain.world.problem.outlier_probability = 1e-6;
    add_errors(chain, random);
    const WhitenedTag clean = chain.whitened();
    chain.reads()[flipped].phase_rad += joint_scene::kPi;
    const WhitenedTag w = chain.whitened();
    for (std::size_t i = 0; i < w.rows.size(); ++i) {
      EXPECT_EQ(w.rows[i].flipped, i == flipped);
      EXPECT_NEAR(w.rows[i].residual, clean.rows[i].residual, 1e-9);
    }
    const double price = price_of_flips([&](std::size_t i) { return i == flipped; }, 0.003) -
                         price_of_flips([](std::size_t) { return false; }, 0.003);
    EXPECT_NEAR(w.cost - clean.cost, price, 0.01);
  }
}

TEST(ChainWhitening, ABurstOfFlipsIsRecognisedReadByRead) {
  std::mt19937 random(34);
  Chain chain = straight_chain(40, 0.015, 0.022 * 0.022);
  chain.world.problem.flip_probability = 0.003;
  add_errors(chain, random);
  const WhitenedTag clean = chain.whitened();
  for (std::size_t i = 20; i < 26; ++i) chain.reads()[i].phase_rad -= joint_scene::kPi;
  const WhitenedTag w = chain.whitened();
  const auto in_burst = [](std::size_t i) { return i >= 20 && i < 26; };
  for (std::size_t i = 0; i < w.rows.size(); ++i) EXPECT_EQ(w.rows[i].flipped, in_burst(i)) << i;
  const double price = price_of_flips(in_burst, 0.003) - price_of_flips([](std::size_t) { return false; }, 0.003);
  EXPECT_NEAR(w.cost - clean.cost, price, 0.02);
  EXPECT_LT(w.cost - clean.cost, 2.0 * std::log(0.997 / 0.003));  // not six times the odds of one
}

TEST(ChainWhitening, ABurstEndsWithThePortsReads) {
  std::mt19937 random(38);
  Chain chain = straight_chain(20, 0.015, 0.022 * 0.022);
  chain.world.problem.flip_probability = 0.003;
  add_errors(chain, random);
  Chain flipped = chain;
  for (std::size_t i = 16; i < 20; ++i) flipped.reads()[i].phase_rad += joint_scene::kPi;
  // The flipped reads on the first port, the others on a second one like it.
  Chain both = flipped;
  const PortState port = both.world.truth.ports[0];
  both.world.truth.ports.assign(2, port);
  for (JointRead read : chain.reads()) {
    read.port = 1;
    both.reads().push_back(read);
  }
  EXPECT_NEAR(both.whitened().cost, flipped.whitened().cost + chain.whitened().cost, 1e-9);
}

TEST(ChainWhitening, AnOutlierHasNoWeightAndNoFollowers) {
  std::mt19937 random(35);
  Chain chain = straight_chain(40, 0.015, 0.022 * 0.022);
  chain.world.problem.flip_probability = 0.003;
  chain.world.problem.outlier_probability = 0.01;
  add_errors(chain, random);
  Chain without = chain;
  chain.reads()[20].phase_rad += 1.5;  // as far from a flip as from the truth
  without.reads().erase(without.reads().begin() + 20);
  const WhitenedTag w = chain.whitened(), rest = without.whitened();
  EXPECT_LT(w.rows[20].weight, 1e-6);
  for (std::size_t i = 0; i < rest.rows.size(); ++i)
    EXPECT_NEAR(w.rows[i < 20 ? i : i + 1].residual, rest.rows[i].residual, 1e-9);
}

TEST(ChainWhitening, WholeTurnsInAPhaseChangeNothing) {
  std::mt19937 random(36);
  Chain chain = straight_chain(30, 0.02, 0.03 * 0.03);
  add_errors(chain, random);
  const WhitenedTag before = chain.whitened();
  for (std::size_t i = 0; i < chain.reads().size(); ++i)
    chain.reads()[i].phase_rad += 2.0 * joint_scene::kPi * (static_cast<double>(i % 5) - 2.0);
  const WhitenedTag after = chain.whitened();
  for (std::size_t i = 0; i < before.rows.size(); ++i)
    EXPECT_NEAR(after.rows[i].residual, before.rows[i].residual, 1e-10);
}

TEST(ChainWhitening, ReadsOfTwoPortsDoNotMix) {
  World world = make_world(1, 12, 1.0);
  auto& reads = world.problem.reads[0];
  WhitenedTag both, second;
  for (JointRead& r : reads) r.phase_rad += 0.1;
  whiten(reads, world.problem, world.truth, world.truth.tags[0], false, both);
  reads.erase(reads.begin(), reads.begin() + 12);
  whiten(reads, world.problem, world.truth, world.truth.tags[0], false, second);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(both.rows[i + 12].residual, second.rows[i].residual);
}

TEST(ChainWhitening, RowDerivativesAreNumericDerivativesOfTheResidual) {
  std::mt19937 random(37);
  World world = make_world(2, 40, 1.4);
  // Dense enough to mix neighbours across knots; small residuals, so that nothing wraps or flips.
  world.problem.structured.length_m = 0.2;
  JointState state = world.truth;
  for (std::size_t k = 1; k < state.knots.size(); ++k)
    state.knots[k].path_correction_W = joint_scene::random_vector(random, 0.005);
  state.log_scale += 0.002;
  const SharedLayout layout = joint_scene::layout_of(state);
  WhitenedTag rows, plus, minus;
  for (std::size_t t = 0; t < 2; ++t) {
    const auto& reads = world.problem.reads[t];
    whiten(reads, world.problem, state, state.tags[t], true, rows);
    Eigen::MatrixXd analytic = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(reads.size()), layout.size() + 4);
    Eigen::MatrixXd numeric = analytic;
    bool mixed = false;
    for (std::size_t i = 0; i < reads.size(); ++i) {
      const WhitenedRow& row = rows.rows[i];
      const auto r = static_cast<Eigen::Index>(i);
      analytic(r, SharedLayout::kLogScale) = row.globals[0];
      analytic(r, SharedLayout::kTimeOffset) = row.globals[1];
      analytic.row(r).segment<5>(layout.port(row.port)) = row.globals.tail<5>();
      for (int k = 0; k < row.knots; ++k)
        if (row.first_knot + k > 0)
          analytic.row(r).segment<6>(layout.knot(row.first_knot + k)) = row.knot[static_cast<std::size_t>(k)];
      analytic.row(r).tail<4>() = row.tag;
      mixed = mixed || row.knots > 2;
    }
    ASSERT_TRUE(mixed);  // some row leans on both sides of a knot
    constexpr double kStep = 1e-5;
    for (int column = 0; column < layout.size() + 4; ++column) {
      const auto shifted = [&](double h, WhitenedTag& out) {
        JointState s = state;
        (column < layout.size() ? joint_scene::shared_state(s, column)
                                : joint_scene::tag_state(s.tags[t], column - layout.size())) += h;
        whiten(reads, world.problem, s, s.tags[t], false, out);
      };
      shifted(kStep, plus);
      shifted(-kStep, minus);
      for (std::size_t i = 0; i < reads.size(); ++i)
        numeric(static_cast<Eigen::Index>(i), column) =
            -(plus.rows[i].residual - minus.rows[i].residual) / (2.0 * kStep);
    }
    // 100 rad to 1e-14 over 0.05 rad and 1e-5: 2e-6; the third derivatives: 1e-7.
    EXPECT_LT((analytic - numeric).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(ChainWhitening, ReusesItsWorkSpaceWithoutATrace) {
  World world = make_world(2, 30, 1.0);
  WhitenedTag used, fresh;
  whiten(world.problem.reads[0], world.problem, world.truth, world.truth.tags[1], true, used);
  whiten(world.problem.reads[1], world.problem, world.truth, world.truth.tags[1], true, used);
  whiten(world.problem.reads[1], world.problem, world.truth, world.truth.tags[1], true, fresh);
  ASSERT_EQ(used.rows.size(), fresh.rows.size());
  EXPECT_EQ(used.cost, fresh.cost);
  for (std::size_t i = 0; i < fresh.rows.size(); ++i) EXPECT_EQ(used.rows[i].residual, fresh.rows[i].residual);
}

TEST(ChainConditioning, OfAnotherStrengthIsTheSameMadeAnew) {
  Chain chain = straight_chain(12, 0.03, 0.01);
  ChainConditioning changed = condition_chains(chain.reads(), 0.2, {kLength_m});
  set_strength(0.6, changed);
  const ChainConditioning fresh = condition_chains(chain.reads(), 0.6, {kLength_m});
  for (std::size_t i = 0; i < fresh.reads.size(); ++i) {
    EXPECT_EQ(changed.reads[i].given.variance_rad2, fresh.reads[i].given.variance_rad2);
    EXPECT_EQ(changed.reads[i].given.weights, fresh.reads[i].given.weights);
  }
}

}  // namespace
}  // namespace rfmvo
