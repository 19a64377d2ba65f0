// SphericalWaveSpectrum::evaluate: cells in lanes, two reads in the halves of a 32-bit lane.
#include "kernels/spherical_wave_spectrum.hpp"
#include "kernels/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/spherical_wave_spectrum_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/fixed_point-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace rfmvo::HWY_NAMESPACE {

using Spectrum = SphericalWaveSpectrum;

#if HWY_TARGET != HWY_SCALAR

// Coordinates of the cells: along x one by one, the plane of y and z in the order of the cells.
struct alignas(64) BlockCoordinates {
  std::array<float, kBlockSide * kBlockSide> y, z;
  std::array<float, kBlockSide> x;
};

BlockCoordinates coordinates_of(const CellBlock& block) {
  BlockCoordinates at;
  for (int i = 0; i < kBlockSide; ++i) at.x[i] = block.first_m[0] + block.step_m[0] * static_cast<float>(i);
  for (int n = 0; n < kBlockSide * kBlockSide; ++n) {
    at.y[n] = block.first_m[1] + block.step_m[1] * static_cast<float>(n / kBlockSide);
    at.z[n] = block.first_m[2] + block.step_m[2] * static_cast<float>(n % kBlockSide);
  }
  return at;
}

void fill_squares(const BlockCoordinates& at, std::span<const Spectrum::Pair> pairs, Spectrum::PairSquares* squares) {
  const hn::CappedTag<float, kBlockSide> d;
  const auto x = hn::Load(d, at.x.data());
  for (std::size_t p = 0; p < pairs.size(); ++p)
    for (std::size_t half = 0; half < 2; ++half) {
      const auto dx = hn::Mul(hn::Sub(x, hn::Set(d, pairs[p].x_m[half])), hn::Set(d, pairs[p].angle_per_m[half]));
      hn::StoreU(hn::Mul(dx, dx), d, squares[p].data() + kBlockSide * half);
    }
}

// So many cells of the plane, for all x.
struct Column {
  hn::Vec<Floats> y, z;
};

struct Sums {
  hn::Vec<Int32s> c[kBlockSide], s[kBlockSide];
};

HWY_INLINE hn::Vec<Floats> plane_square(const Column& at, const Spectrum::Pair& pair, std::size_t half) {
  const Floats d;
  const auto t = hn::Set(d, pair.angle_per_m[half]);
  const auto dy = hn::Mul(hn::Sub(at.y, hn::Set(d, pair.y_m[half])), t);
  const auto dz = hn::Mul(hn::Sub(at.z, hn::Set(d, pair.z_m[half])), t);
  return hn::Add(hn::Mul(dy, dy), hn::Mul(dz, dz));
}

template <bool kBoth>
HWY_INLINE void add_pair(const Column& at, const Spectrum::Pair& pair, const Spectrum::PairSquares& squares,
                         Sums& sums) {
  const Floats d;
  const auto yz0 = plane_square(at, pair, 0);
  const auto yz1 = plane_square(at, pair, 1);
  const auto phase = low_halves(hn::Set(Int32s(), pair.phase_q16[0]), hn::Set(Int32s(), pair.phase_q16[1]));
  const auto quarter = hn::Set(Int16s(), static_cast<std::int16_t>(kQuarterTurn));
  for (int i = 0; i < kBlockSide; ++i) {
    const auto wave0 = hn::NearestInt(hn::Sqrt(hn::Add(yz0, hn::Set(d, squares[i]))));
    const auto wave1 = hn::NearestInt(hn::Sqrt(hn::Add(yz1, hn::Set(d, squares[kBlockSide + i]))));
    const auto angle = hn::Sub(phase, low_halves(wave0, wave1));
    auto c = cosine_q15(angle), s = cosine_q15(hn::Sub(angle, quarter));
    if constexpr (!kBoth) {
      c = without_high_halves(c);
      s = without_high_halves(s);
    }
    sums.c[i] = add_halves(sums.c[i], c);
    sums.s[i] = add_halves(sums.s[i], s);
  }
}

HWY_INLINE void evaluate_column(const Spectrum& spectrum, const Column& at, const Spectrum::PairSquares* squares,
                                float* power) {
  const Floats d;
  hn::Vec<Floats> total[kBlockSide];
  for (auto& t : total) t = hn::Zero(d);
  for (const Spectrum::Group& group : spectrum.groups()) {
    Sums sums;
    for (auto& c : sums.c) c = hn::Zero(Int32s());
    for (auto& s : sums.s) s = hn::Zero(Int32s());
    const std::size_t both = group.end - (group.odd ? 1 : 0);
    for (std::size_t p = group.first; p < both; ++p) add_pair<true>(at, spectrum.pairs()[p], squares[p], sums);
    if (group.odd) add_pair<false>(at, spectrum.pairs()[both], squares[both], sums);
    for (int i = 0; i < kBlockSide; ++i) {
      const auto c = hn::ConvertTo(d, sums.c[i]), s = hn::ConvertTo(d, sums.s[i]);
      const auto strength = hn::Add(hn::Mul(c, c), hn::Mul(s, s));
      total[i] = hn::Add(total[i], hn::Mul(hn::Set(d, group.weight), strength));
    }
  }
  for (int i = 0; i < kBlockSide; ++i) hn::Store(total[i], d, power + i * kBlockSide * kBlockSide);
}

void evaluate_block(const Spectrum& spectrum, const CellBlock& block, Spectrum::PairSquares* squares,
                    BlockPower& power) {
  const Floats d;
  const BlockCoordinates at = coordinates_of(block);
  fill_squares(at, spectrum.pairs(), squares);
  for (std::size_t n = 0; n < at.y.size(); n += hn::Lanes(d))
    evaluate_column(spectrum, {hn::Load(d, at.y.data() + n), hn::Load(d, at.z.data() + n)}, squares, power.data() + n);
}

// The largest power, then the first cell that has it.
int first_of_largest(const BlockPower& power) {
  const Floats d;
  auto largest = hn::Load(d, power.data());
  for (std::size_t n = hn::Lanes(d); n < power.size(); n += hn::Lanes(d))
    largest = hn::Max(largest, hn::Load(d, power.data() + n));
  largest = hn::MaxOfLanes(d, largest);
  for (std::size_t n = 0; n < power.size(); n += hn::Lanes(d)) {
    const auto at = hn::FindFirstTrue(d, hn::Eq(hn::Load(d, power.data() + n), largest));
    if (at >= 0) return static_cast<int>(n) + static_cast<int>(at);
  }
  return 0;
}

#else  // one lane

int first_of_largest(const BlockPower& power) { return strongest_cell_scalar(power); }

void evaluate_block(const Spectrum& spectrum, const CellBlock& block, Spectrum::PairSquares*, BlockPower& power) {
  spectrum.evaluate_scalar(block, power);
}

#endif

}  // namespace rfmvo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rfmvo {

HWY_EXPORT(evaluate_block);
HWY_EXPORT(first_of_largest);

void SphericalWaveSpectrum::evaluate(const CellBlock& block, BlockPower& power) {
  HWY_DYNAMIC_DISPATCH(evaluate_block)(*this, block, squares_.data(), power);
}

int strongest_cell(const BlockPower& power) { return HWY_DYNAMIC_DISPATCH(first_of_largest)(power); }

}  // namespace rfmvo
#endif
