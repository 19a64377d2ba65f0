#include "bound/lobes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include "base/units.hpp"
#include "bound/information.hpp"
#include "rf/phase.hpp"

namespace rfmvo::bound {
namespace {

constexpr std::size_t kFewestReads = 5;  // four unknowns and one to judge by
constexpr std::size_t kMostPeaks = 60;   // of the search, that are looked at closely
constexpr double kHopeless = 40.0;       // squared distance of phases, in sigmas: wins once in a thousand
constexpr double kTie = 1e-6;            // of costs
constexpr double kSamePlace_m = 0.06;    // within the true lobe, or two names of one

// The reads of one tag: where from, and how their errors go together.
struct TagReads {
  std::vector<Eigen::Vector3d> antenna_S_m;
  Eigen::VectorXd wavenumber_rad_m;
  Eigen::MatrixXd error_root;  // lower Cholesky factor of the error covariance

  [[nodiscard]] Eigen::Index size() const { return wavenumber_rad_m.size(); }
  [[nodiscard]] Eigen::VectorXd phases_at(const Eigen::Vector3d& p_S_m) const {
    Eigen::VectorXd phase(size());
    for (Eigen::Index i = 0; i < size(); ++i)
      phase[i] = wavenumber_rad_m[i] * (antenna_S_m[static_cast<std::size_t>(i)] - p_S_m).norm();
    return phase;
  }
  [[nodiscard]] Eigen::VectorXd white(const Eigen::VectorXd& v) const {
    return error_root.triangularView<Eigen::Lower>().solve(v);
  }
};

TagReads reads_of(const World& world, std::size_t tag) {
  TagReads reads;
  std::vector<Read> sorted;
  std::vector<Eigen::MatrixXd> blocks;
  for (std::size_t port = 0; port < world.lever_arms_C_m.size(); ++port) {
    std::vector<Read> chain;
    std::copy_if(world.reads.begin(), world.reads.end(), std::back_inserter(chain),
                 [&](const Read& r) { return r.tag == tag && r.port == port; });
    if (chain.empty()) continue;
    blocks.push_back(Eigen::LLT<Eigen::MatrixXd>(error_covariance(chain, world.structured)).matrixL());
    sorted.insert(sorted.end(), chain.begin(), chain.end());
  }
  const auto count = std::ssize(sorted);
  reads.wavenumber_rad_m.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Read& read = sorted[static_cast<std::size_t>(i)];
    reads.wavenumber_rad_m[i] = wavenumber_rad_m(read.frequency_hz);
    reads.antenna_S_m.push_back(world.T_S_C(read.t_s) * world.lever_arms_C_m[read.port]);
  }
  reads.error_root = Eigen::MatrixXd::Zero(count, count);
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& block : blocks) {
    reads.error_root.block(at, at, block.rows(), block.rows()) = block;
    at += block.rows();
  }
  return reads;
}

// Values on a cube of n^3 cells.
struct Grid {
  int n = 0;
  std::vector<float> value;
  [[nodiscard]] float at(int x, int y, int z) const { return value[static_cast<std::size_t>((x * n + y) * n + z)]; }
  [[nodiscard]] bool is_peak(int x, int y, int z) const {
    const float here = at(x, y, z);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (at(x + dx, y + dy, z + dz) > here) return false;
    return true;
  }
};

// Where the phases of the true place would add up best, strongest first.
std::vector<Eigen::Vector3d> spectrum_peaks(const TagReads& reads, const Eigen::Vector3d& truth,
                                            const LobeSettings& settings) {
  // Single precision: 1e-5 rad at these distances.
  const auto count = static_cast<Eigen::Index>(reads.antenna_S_m.size());
  const Eigen::ArrayXf true_phase = reads.phases_at(truth).array().cast<float>();
  const Eigen::ArrayXf wavenumber = reads.wavenumber_rad_m.array().cast<float>();
  Eigen::ArrayX3f antenna(count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
    antenna.row(i) = reads.antenna_S_m[static_cast<std::size_t>(i)].transpose().cast<float>();
  const int half = static_cast<int>(std::ceil(settings.region_m / settings.cell_m));
  Grid grid{2 * half + 1, {}};
  const auto place = [&](int x, int y, int z) -> Eigen::Vector3d {
    return truth + settings.cell_m * Eigen::Vector3d(x - half, y - half, z - half);
  };
  grid.value.reserve(static_cast<std::size_t>(grid.n) * static_cast<std::size_t>(grid.n * grid.n));
  Eigen::ArrayXf difference(count);
  for (int x = 0; x < grid.n; ++x)
    for (int y = 0; y < grid.n; ++y)
      for (int z = 0; z < grid.n; ++z) {
        const Eigen::RowVector3f p = place(x, y, z).transpose().cast<float>();
        difference = true_phase - wavenumber * ((antenna.col(0) - p[0]).square() + (antenna.col(1) - p[1]).square() +
                                                (antenna.col(2) - p[2]).square())
                                                   .sqrt();
        grid.value.push_back(std::hypot(difference.cos().sum(), difference.sin().sum()));
      }
  std::vector<std::pair<float, Eigen::Vector3d>> peaks;
  for (int x = 1; x + 1 < grid.n; ++x)
    for (int y = 1; y + 1 < grid.n; ++y)
      for (int z = 1; z + 1 < grid.n; ++z)
        if (grid.is_peak(x, y, z)) peaks.emplace_back(grid.at(x, y, z), place(x, y, z));
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (peaks.size() > kMostPeaks) peaks.resize(kMostPeaks);
  std::vector<Eigen::Vector3d> places;
  for (const auto& [power, p] : peaks) places.push_back(p);
  return places;
}

// One place that competes, linearised: what is left of phase differences once position and offset are fitted there.
struct Lobe {
  Eigen::Vector3d p_S_m;
  Eigen::VectorXd difference_rad;  // true phases less those of here, offset fitted, each in (-pi, pi]
  Eigen::MatrixXd J_white;         // whitened derivatives by position and offset, orthonormal columns

  // Twice the cost of phases that are off by `error` from the true ones.
  [[nodiscard]] double cost(const TagReads& reads, const Eigen::VectorXd& error_rad) const {
    const Eigen::VectorXd r = reads.white((difference_rad + error_rad).unaryExpr(&wrap_rad));
    return r.squaredNorm() - (J_white.transpose() * r).squaredNorm();
  }
};

Eigen::MatrixXd derivatives_at(const TagReads& reads, const Eigen::Vector3d& p_S_m) {
  Eigen::MatrixXd J(reads.size(), 4);
  for (Eigen::Index i = 0; i < reads.size(); ++i) {
    const Eigen::Vector3d ray = p_S_m - reads.antenna_S_m[static_cast<std::size_t>(i)];
    J.row(i) << reads.wavenumber_rad_m[i] * ray.normalized().transpose(), 1.0;
  }
  return J;
}

// The local maximum of the likelihood near a place, by damped Gauss-Newton steps.
Lobe refine(const TagReads& reads, const Eigen::VectorXd& true_phase, Eigen::Vector3d p_S_m) {
  constexpr int kSteps = 15;
  const auto differences = [&](const Eigen::Vector3d& p) -> Eigen::VectorXd {
    const Eigen::VectorXd raw = true_phase - reads.phases_at(p);
    const double offset = std::atan2(raw.array().sin().sum(), raw.array().cos().sum());
    return (raw.array() - offset).unaryExpr(&wrap_rad);
  };
  double damping = 1e-3;
  Eigen::VectorXd d = differences(p_S_m);
  double cost = reads.white(d).squaredNorm();
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::MatrixXd J = reads.error_root.triangularView<Eigen::Lower>().solve(derivatives_at(reads, p_S_m));
    Eigen::Matrix4d H = J.transpose() * J;
    H.diagonal() *= 1.0 + damping;
    const Eigen::Vector4d move = H.ldlt().solve(J.transpose() * reads.white(d));
    const Eigen::Vector3d there = p_S_m + move.head<3>();
    const Eigen::VectorXd d_there = differences(there);
    const double cost_there = reads.white(d_there).squaredNorm();
    if (cost_there < cost) {
      p_S_m = there;
      d = d_there;
      cost = cost_there;
      damping *= 0.3;
    } else {
      damping = std::max(1e-3, damping) * 10.0;
    }
  }
  const Eigen::MatrixXd J = reads.error_root.triangularView<Eigen::Lower>().solve(derivatives_at(reads, p_S_m));
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(J);
  return {p_S_m, d, qr.householderQ() * Eigen::MatrixXd::Identity(J.rows(), J.cols())};
}

// The true place first.
std::vector<Lobe> competing(const TagReads& reads, const Eigen::Vector3d& truth, const LobeSettings& settings) {
  const Eigen::VectorXd true_phase = reads.phases_at(truth), none = Eigen::VectorXd::Zero(reads.size());
  std::vector<Lobe> lobes{refine(reads, true_phase, truth)};
  for (const Eigen::Vector3d& peak : spectrum_peaks(reads, truth, settings)) {
    Lobe lobe = refine(reads, true_phase, peak);
    const bool known = std::any_of(lobes.begin(), lobes.end(),
                                   [&](const Lobe& other) { return (other.p_S_m - lobe.p_S_m).norm() < kSamePlace_m; });
    if (!known && lobe.cost(reads, none) < kHopeless) lobes.push_back(std::move(lobe));
  }
  return lobes;
}

TagLobes tag_lobes(const TagReads& reads, const Eigen::Vector3d& truth, const LobeSettings& settings,
                   std::mt19937_64& random) {
  TagLobes result;
  if (static_cast<std::size_t>(reads.size()) < kFewestReads) return result;
  const std::vector<Lobe> lobes = competing(reads, truth, settings);
  result.lobes = lobes.size() - 1;
  if (result.lobes == 0) return result;
  std::normal_distribution<double> normal;
  const double weight = 1.0 / static_cast<double>(settings.draws);
  std::vector<double> costs(lobes.size());
  for (std::size_t draw = 0; draw < settings.draws; ++draw) {
    const Eigen::VectorXd error =
        reads.error_root * Eigen::VectorXd::NullaryExpr(reads.size(), [&] { return normal(random); });
    for (std::size_t k = 0; k < lobes.size(); ++k) costs[k] = lobes[k].cost(reads, error);
    const double least = *std::min_element(costs.begin(), costs.end());
    // An exact mirror is exactly as likely.
    const auto wins = [&](double cost) { return cost <= least + kTie; };
    const double share = weight / static_cast<double>(std::count_if(costs.begin(), costs.end(), wins));
    for (std::size_t k = 1; k < lobes.size(); ++k) {
      if (!wins(costs[k])) continue;
      result.wrong_probability += share;
      result.square_m2 += share * (lobes[k].p_S_m - truth).squaredNorm();
    }
  }
  return result;
}

}  // namespace

std::optional<double> rmse_with_lobes_m(const TagBound& bound, const TagLobes& lobes) {
  if (!bound.sigma_m) return std::nullopt;
  return std::sqrt((1.0 - lobes.wrong_probability) * *bound.sigma_m * *bound.sigma_m + lobes.square_m2);
}

Lobes lobes_of(const World& world, const Bound& bound, const LobeSettings& settings) {
  std::mt19937_64 random(settings.seed);
  Lobes all;
  double square_m2 = 0.0, count = 0.0;
  for (std::size_t tag = 0; tag < world.tags.size(); ++tag) {
    all.tags.push_back(tag_lobes(reads_of(world, tag), world.tags[tag].p_S_X_m, settings, random));
    const auto rmse_m = rmse_with_lobes_m(bound.tags[tag], all.tags.back());
    if (!rmse_m) continue;
    count += 1.0;
    square_m2 += *rmse_m * *rmse_m;
    all.wrong_share += all.tags.back().wrong_probability;
  }
  if (count == 0.0) return all;
  all.wrong_share /= count;
  all.rmse_m = std::sqrt(square_m2 / count);
  return all;
}

}  // namespace rfmvo::bound
