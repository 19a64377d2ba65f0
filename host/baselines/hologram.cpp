#include "baselines/hologram.hpp"

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo::baselines {

Eigen::Vector3d Region::cell_centre(int i, int j, int k) const {
  const Eigen::Array3d index(i, j, k), middle(0.5 * (cells[0] - 1), 0.5 * (cells[1] - 1), 0.5 * (cells[2] - 1));
  return centre_m + cell_m * (index - middle).matrix();
}

HologramPeak likeliest_cell(const Region& region, const std::function<double(const Eigen::Vector3d&)>& likelihood) {
  HologramPeak peak;
  peak.likelihood = -1.0;
  for (int i = 0; i < region.cells[0]; ++i)
    for (int j = 0; j < region.cells[1]; ++j)
      for (int k = 0; k < region.cells[2]; ++k) {
        const Eigen::Vector3d p = region.cell_centre(i, j, k);
        const double here = likelihood(p);
        if (!(here > peak.likelihood)) continue;
        const bool edge = i == 0 || j == 0 || k == 0 || i == region.cells[0] - 1 || j == region.cells[1] - 1 ||
                          k == region.cells[2] - 1;
        peak = {p, here, edge};
      }
  return peak;
}

Residuals::Residuals(std::span<const KnownRead> reads) : origin_(Eigen::Vector3d::Zero()) {
  RFMVO_ASSERT(!reads.empty());
  origin_ = reads.front().p_W_A_m;  // near: float has more digits for small numbers
  const auto n = static_cast<Eigen::Index>(reads.size());
  for (Eigen::ArrayXf* a : {&x_, &y_, &z_, &phase_, &turns_per_m_, &turns_}) a->resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const KnownRead& read = reads[static_cast<std::size_t>(i)];
    const Eigen::Vector3f p = (read.p_W_A_m - origin_).cast<float>();
    x_(i) = p.x();
    y_(i) = p.y();
    z_(i) = p.z();
    phase_(i) = static_cast<float>(read.phase_rad / kTwoPi);
    turns_per_m_(i) = static_cast<float>(2.0 / read.wavelength_m);  // there and back
  }
}

const Eigen::ArrayXf& Residuals::at(const Eigen::Vector3d& p_W_X_m) {
  const Eigen::Vector3f p = (p_W_X_m - origin_).cast<float>();
  turns_ = phase_ - turns_per_m_ * ((x_ - p.x()).square() + (y_ - p.y()).square() + (z_ - p.z()).square()).sqrt();
  return turns_;
}

std::vector<std::vector<KnownRead>> by_group(std::span<const KnownRead> reads) {
  std::vector<std::vector<KnownRead>> groups;
  for (const KnownRead& read : reads) {
    const auto group = static_cast<std::size_t>(read.group);
    if (group >= groups.size()) groups.resize(group + 1);
    groups[group].push_back(read);
  }
  return groups;
}

TurnTable::TurnTable(const std::function<std::complex<double>(double)>& function) {
  for (std::uint32_t n = 0; n < kSteps; ++n) {
    const double turns = static_cast<double>(n) / kSteps;
    const std::complex<double> value = function(kTwoPi * (turns < 0.5 ? turns : turns - 1.0));
    values_.emplace_back(static_cast<float>(value.real()), static_cast<float>(value.imag()));
  }
}

}  // namespace rfmvo::baselines
