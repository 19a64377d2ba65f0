// Real Impinj phase (AdaRF, IMWUT 2019) through the estimator's measurement and error model: one antenna on a slide,
// path, scale and tag height known. What is left is the phase error of a real room, 0.9 m from the tags.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "base/units.hpp"
#include "estimator/electrical_length.hpp"
#include "estimator/structured_strength.hpp"
#include "estimator/tag_climb.hpp"
#include "estimator/tag_modes.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

const std::string kAdaRF = RFMVO_TEST_DATA "/rfid-adarf-a";
constexpr double kCarrier_hz = 922.375e6;  // middle of the eight channels
constexpr double kSpeed_m_s = 0.1;         // points have no stamps

std::vector<std::vector<std::string>> rows_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::stringstream cells(line);
    std::vector<std::string>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

struct PointRead {  // one channel at one point of the slide
  int point;
  double x_m, phase_rad, frequency_term_rad_m, rssi_db, count;
};
using Experiment = std::map<std::string, std::vector<PointRead>>;  // by EPC

Experiment experiment_of(const std::string& name, const std::map<std::string, Eigen::Vector3d>& tags) {
  Experiment e;
  for (const auto& row : rows_of(kAdaRF + "/" + name + ".csv"))
    if (tags.contains(row[0]))
      e[row[0]].push_back({std::stoi(row[1]), std::stod(row[2]), std::stod(row[5]),
                           2.0 * kTwoPi * (std::stod(row[3]) - kCarrier_hz) / kSpeedOfLight_m_s, std::stod(row[7]),
                           std::stod(row[4])});
  for (auto& [epc, reads] : e)
    std::stable_sort(reads.begin(), reads.end(), [](const auto& a, const auto& b) { return a.point < b.point; });
  return e;
}

// Cable and mean distance turn the phase from channel to channel by one length, which the channels tell themselves.
double length_of(const Experiment& experiment) {
  std::vector<std::vector<TimedPhase>> chains;
  for (const auto& [epc, reads] : experiment) {
    auto& chain = chains.emplace_back();
    for (const PointRead& r : reads) chain.push_back({r.x_m / kSpeed_m_s, r.phase_rad, r.frequency_term_rad_m});
  }
  return electrical_length_from_hops(chains).length_m;
}

// The channels of a point as one read at the middle channel: their structured error is the same (DESIGN 2.7).
std::vector<JointRead> reads_at_points(const std::vector<PointRead>& all, double length_m) {
  constexpr double kPlace_rad = 0.03;  // a millimetre of the slide, there and back
  std::vector<JointRead> reads;
  for (std::size_t i = 0; i < all.size();) {
    std::complex<double> sum;
    double rssi_db = 0.0, n = 0.0;
    JointRead read;
    for (const std::size_t first = i; i < all.size() && all[i].point == all[first].point; ++i) {
      sum += std::polar(1.0, all[i].phase_rad - all[i].frequency_term_rad_m * length_m);
      rssi_db += all[i].rssi_db;
      n += 1.0;
      read.geometry.n_W = read.p_W_A = {all[i].x_m, 0.0, 0.0};
    }
    read.geometry.wavenumber_rad_m = 2.0 * kTwoPi * kCarrier_hz / kSpeedOfLight_m_s;
    read.phase_rad = std::arg(sum);
    read.rssi_db = rssi_db / n;
    read.white_rad2 = std::pow(white_sigma_rad(read.rssi_db), 2) / n + kPlace_rad * kPlace_rad;
    reads.push_back(read);
  }
  double strong_db = reads.front().rssi_db;
  for (const JointRead& r : reads) strong_db = std::max(strong_db, r.rssi_db);
  for (JointRead& r : reads) r.fade_db = strong_db - r.rssi_db;
  return reads;
}

// The likeliest place on the plane z = 0, the antenna's height and the tags': by symmetry a climb stays on it.
TagLikelihood::Maximum locate(const JointProblem& problem, const JointState& state, std::size_t t) {
  TagLikelihood likelihood(problem.reads[t], problem, state, state.tags[t].structured_sigma_rad);
  TagLikelihood::Maximum best;
  best.cost = 1e99;
  for (double x_m = -0.25; x_m < 1.3; x_m += 0.15)
    for (double y_m = 0.3; y_m < 1.9; y_m += 0.2) {
      const TagLikelihood::Maximum top = likelihood.climb({x_m, y_m, 0.0});
      if (top.p_W_X.allFinite() && top.p_W_X.y() > 0.1 && top.cost < best.cost) best = top;
    }
  return best;
}

struct Score {
  std::vector<double> errors_m;
  int inside = 0;
};

void score_experiment(const Experiment& experiment, const std::map<std::string, Eigen::Vector3d>& truth, Score& score) {
  const double length_m = length_of(experiment);
  JointProblem problem;
  problem.intervals.resize(1);
  JointState state;
  state.ports.resize(1);
  state.knots.resize(2);
  std::vector<Eigen::Vector3d> places;
  for (const auto& [epc, reads] : experiment) {
    problem.reads.push_back(reads_at_points(reads, length_m));
    state.tags.emplace_back();
    places.push_back(truth.at(epc));
  }
  const StrengthOptions strength;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t t = 0; t < places.size(); ++t) {
      const auto top = locate(problem, state, t);
      state.tags[t].p_W_X = top.p_W_X;
      state.tags[t].offset_rad = top.offset_rad;
    }
    problem.structured.fade_exponent = estimate_fade_exponent(problem, state, strength);
    problem.structured = estimate_correlation(problem, state, 0.058);
    estimate_structured_strength(problem, strength, state);
  }
  for (std::size_t t = 0; t < places.size(); ++t) {
    const auto top = locate(problem, state, t);
    const Eigen::Vector2d error = (top.p_W_X - places[t]).head<2>();
    constexpr double kChi2_95_2dof = 5.991;
    score.errors_m.push_back(error.norm());
    score.inside += error.dot(Eigen::Matrix2d(top.covariance.topLeftCorner<2, 2>()).inverse() * error) < kChi2_95_2dof;
  }
}

TEST(RealPhase, EllipsesOfTagsFarApartHoldTheTruth) {
  if (!std::filesystem::exists(kAdaRF)) GTEST_SKIP() << "no data at " << kAdaRF;
  std::map<std::string, std::map<std::string, Eigen::Vector3d>> truth;
  for (const auto& row : rows_of(kAdaRF + "/truth.csv"))
    if (row[0] == "1-test" && row[6] == "1")
      truth[row[1]][row[2]] = {std::stod(row[3]), std::stod(row[4]), std::stod(row[5])};
  Score score;
  for (const auto& [name, tags] : truth) score_experiment(experiment_of(name, tags), tags, score);
  double mean_m = 0.0;
  for (const double e : score.errors_m) mean_m += e / static_cast<double>(score.errors_m.size());
  const double inside = static_cast<double>(score.inside) / static_cast<double>(score.errors_m.size());
  RecordProperty("mean_m", std::to_string(mean_m));
  RecordProperty("inside", std::to_string(inside));
  std::printf("1-test: %zu passes, mean 2-D error %.3f m, %.1f %% inside the 95 %% ellipse\n", score.errors_m.size(),
              mean_m, 100.0 * inside);
  EXPECT_EQ(score.errors_m.size(), 27U);
  EXPECT_GE(inside, 0.85);
  // A plain hologram: 0.10 m median. Ranges are 6 cm too long on average, as a phase centre before or behind the antenna's
  // face makes them. A guard, not the goal (0.08).
  EXPECT_LE(mean_m, 0.13);
}

}  // namespace
}  // namespace rfmvo
