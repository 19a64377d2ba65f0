// PlaneWaveSpectrum::evaluate: directions in lanes, two steps in the halves of a 32-bit lane.
#include <algorithm>
#include <array>
#include <vector>

#include "base/assert.hpp"
#include "kernels/plane_wave_spectrum.hpp"
#include "kernels/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/plane_wave_spectrum_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "kernels/fixed_point-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace rfmvo::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR

constexpr std::size_t kMaxLanes = 16;

struct Lanes {
  hn::Vec<Floats> x, y, z;
};

// Angles of two steps, 2^32 = one turn, and what a scale more adds.
struct PairAngles {
  hn::Vec<Int32s> angle[2], step[2];
};

template <int kShift>
HWY_INLINE hn::Vec<Int32s> angle_q32(const Lanes& u, const std::array<float, 3>& slope) {
  const Floats d;
  const auto xy = hn::Add(hn::Mul(hn::Set(d, slope[0]), u.x), hn::Mul(hn::Set(d, slope[1]), u.y));
  return hn::ShiftLeft<kShift>(hn::NearestInt(hn::Add(xy, hn::Mul(hn::Set(d, slope[2]), u.z))));
}

// Scales begin <= n < end.
struct Scales {
  int begin, end;
};

HWY_INLINE PairAngles angles_of(const PlaneWaveSpectrum::Pair& pair, const Lanes& u, Scales scales) {
  PairAngles a;
  for (std::size_t half = 0; half < 2; ++half) {
    const auto phase = hn::Set(Int32s(), pair.phase_q32[half]);
    a.step[half] = angle_q32<5>(u, pair.step[half]);
    const auto first =
        hn::Add(angle_q32<8>(u, pair.first[half]), hn::Mul(a.step[half], hn::Set(Int32s(), scales.begin)));
    a.angle[half] = hn::Add(phase, first);
  }
  return a;
}

// The cosines of both steps; moves on to the next scale.
HWY_INLINE hn::Vec<Int16s> next_cosines(PairAngles& a) {
  const auto cosines = cosine_q15(high_halves(a.angle[0], a.angle[1]));
  a.angle[0] = hn::Add(a.angle[0], a.step[0]);
  a.angle[1] = hn::Add(a.angle[1], a.step[1]);
  return cosines;
}

// Two pairs at a time halve the traffic of the sums.
HWY_INLINE void add_two_pairs(const PlaneWaveSpectrum::Pair* pairs, const Lanes& u, Scales scales, std::int32_t* sums) {
  const Int32s d;
  PairAngles a = angles_of(pairs[0], u, scales), b = angles_of(pairs[1], u, scales);
  for (int n = scales.begin; n < scales.end; ++n, sums += kMaxLanes)
    hn::Store(add_halves(add_halves(hn::Load(d, sums), next_cosines(a)), next_cosines(b)), d, sums);
}

// One scale, the first: no step, and the sums stay in a register.
template <bool kBoth>
HWY_INLINE hn::Vec<Int32s> add_pair_once(const PlaneWaveSpectrum::Pair& pair, const Lanes& u, hn::Vec<Int32s> sum) {
  hn::Vec<Int32s> angle[2];
  for (std::size_t half = 0; half < 2; ++half)
    angle[half] = hn::Add(hn::Set(Int32s(), pair.phase_q32[half]), angle_q32<8>(u, pair.first[half]));
  auto cosines = cosine_q15(high_halves(angle[0], angle[1]));
  if constexpr (!kBoth) cosines = without_high_halves(cosines);
  return add_halves(sum, cosines);
}

hn::Vec<Int32s> add_steps_once(const PlaneWaveSpectrum& spectrum, const Lanes& u) {
  const auto pairs = spectrum.pairs();
  const std::size_t both = pairs.size() - (spectrum.odd() ? 1 : 0);
  auto even = hn::Zero(Int32s()), odd = even;  // two chains of additions
  std::size_t p = 0;
  for (; p + 2 <= both; p += 2) {
    even = add_pair_once<true>(pairs[p], u, even);
    odd = add_pair_once<true>(pairs[p + 1], u, odd);
  }
  if (p < both) even = add_pair_once<true>(pairs[p], u, even);
  if (spectrum.odd()) odd = add_pair_once<false>(pairs[both], u, odd);
  return hn::Add(even, odd);
}

template <bool kBoth>
HWY_INLINE void add_pair(const PlaneWaveSpectrum::Pair& pair, const Lanes& u, Scales scales, std::int32_t* sums) {
  const Int32s d;
  PairAngles a = angles_of(pair, u, scales);
  for (int n = scales.begin; n < scales.end; ++n, sums += kMaxLanes) {
    auto cosines = next_cosines(a);
    if constexpr (!kBoth) cosines = without_high_halves(cosines);
    hn::Store(add_halves(hn::Load(d, sums), cosines), d, sums);
  }
}

// All steps and scales for one vector of directions; scale n is at sums + n * kMaxLanes.
void add_steps(const PlaneWaveSpectrum& spectrum, const Lanes& u, Scales scales, std::int32_t* sums) {
  const auto pairs = spectrum.pairs();
  const std::size_t both = pairs.size() - (spectrum.odd() ? 1 : 0);
  std::size_t p = 0;
  for (; p + 2 <= both; p += 2) add_two_pairs(&pairs[p], u, scales, sums);
  if (p < both) add_pair<true>(pairs[p], u, scales, sums);
  if (spectrum.odd()) add_pair<false>(pairs[both], u, scales, sums);
}

// Up to a vector of floats, the rest zero.
HWY_INLINE hn::Vec<Floats> load_some(const float* from, std::size_t count) {
  const Floats d;
  if (count == hn::Lanes(d)) return hn::LoadU(d, from);
  alignas(64) std::array<float, kMaxLanes> some{};
  std::copy_n(from, count, some.begin());
  return hn::Load(d, some.data());
}

HWY_INLINE void store_some(const std::int32_t* from, std::size_t count, std::int32_t* to) {
  const Int32s d;
  if (count == hn::Lanes(d)) {
    hn::StoreU(hn::Load(d, from), d, to);
  } else {
    std::copy_n(from, count, to);
  }
}

void evaluate_plane(const PlaneWaveSpectrum& spectrum, const Directions& directions, int begin, int end,
                    std::int32_t* sums) {
  static_assert(HWY_MAX_BYTES <= 4 * kMaxLanes);
  const std::size_t lanes = hn::Lanes(Floats()), count = directions.size();
  struct alignas(64) Row : std::array<std::int32_t, kMaxLanes> {};
  const bool once = begin == 0 && end == 1;
  std::vector<Row> rows(static_cast<std::size_t>(end - begin));
  if (rows.empty()) return;
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t some = std::min(lanes, count - first);
    const Lanes u{load_some(&directions.x[first], some), load_some(&directions.y[first], some),
                  load_some(&directions.z[first], some)};
    if (once) {
      hn::Store(add_steps_once(spectrum, u), Int32s(), rows.data()->data());
    } else {
      std::fill(rows.begin(), rows.end(), Row{});
      add_steps(spectrum, u, {begin, end}, rows.data()->data());
    }
    for (std::size_t n = 0; n < rows.size(); ++n) store_some(rows[n].data(), some, sums + n * count + first);
  }
}

#else  // one lane

void evaluate_plane(const PlaneWaveSpectrum& spectrum, const Directions& directions, int begin, int end,
                    std::int32_t* sums) {
  spectrum.evaluate_scalar(directions, begin, end, {sums, directions.size() * static_cast<std::size_t>(end - begin)});
}

#endif

}  // namespace rfmvo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rfmvo {

HWY_EXPORT(evaluate_plane);

void PlaneWaveSpectrum::evaluate(const Directions& directions, int begin, int end, std::span<std::int32_t> sums) const {
  RFMVO_ASSERT(0 <= begin && begin <= end && sums.size() == directions.size() * static_cast<std::size_t>(end - begin));
  RFMVO_ASSERT(directions.y.size() == directions.size() && directions.z.size() == directions.size());
  HWY_DYNAMIC_DISPATCH(evaluate_plane)(*this, directions, begin, end, sums.data());
}

}  // namespace rfmvo
#endif
