// binary_angle.hpp in Highway vectors: the same integer operations, lane by lane. Included once per
// target (no include guard of the usual kind).
#if defined(RFMVO_KERNELS_FIXED_POINT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RFMVO_KERNELS_FIXED_POINT_INL
#undef RFMVO_KERNELS_FIXED_POINT_INL
#else
#define RFMVO_KERNELS_FIXED_POINT_INL
#endif

#include <hwy/highway.h>

#include "kernels/binary_angle.hpp"

HWY_BEFORE_NAMESPACE();
namespace rfmvo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR  // one lane per vector: there the kernels run the scalar definition

using Int16s = hn::ScalableTag<std::int16_t>;
using Int32s = hn::ScalableTag<std::int32_t>;
using Floats = hn::ScalableTag<float>;

// cosine_q15.
template <class V>
HWY_INLINE V cosine_q15(V angle) {
  const Int16s d;
  const V folded = hn::Xor(angle, hn::ShiftRight<15>(angle));
  const V x = hn::Xor(hn::Add(folded, folded), hn::Set(d, 0x7FFF));  // 32767 - 2 folded
  const V xx = hn::MulFixedPoint15(x, x);
  const V k35 = hn::Add(hn::MulFixedPoint15(xx, hn::Set(d, kSine5_q15)), hn::Set(d, kSine3_q15));
  const V k135 = hn::Add(hn::MulFixedPoint15(k35, xx), hn::Set(d, kSine1_q15));
  return hn::SaturatedAdd(x, hn::MulFixedPoint15(x, k135));
}

// Two angles per 32-bit lane: the low halves of `low` and of `high`.
template <class V>
HWY_INLINE hn::Vec<Int16s> low_halves(V low, V high) {
  const Int16s d;
#if HWY_TARGET == HWY_NEON
  return hn::Vec<Int16s>(vtrn1q_s16(hn::BitCast(d, low).raw, hn::BitCast(d, high).raw));
#else
  return hn::OddEven(hn::BitCast(d, hn::ShiftLeft<16>(high)), hn::BitCast(d, low));
#endif
}

// The same of the high halves.
template <class V>
HWY_INLINE hn::Vec<Int16s> high_halves(V low, V high) {
  const Int16s d;
#if HWY_TARGET == HWY_NEON
  return hn::Vec<Int16s>(vtrn2q_s16(hn::BitCast(d, low).raw, hn::BitCast(d, high).raw));
#else
  return hn::OddEven(hn::BitCast(d, high), hn::BitCast(d, hn::ShiftRight<16>(low)));
#endif
}

// sum + the two int16 of every 32-bit lane.
HWY_INLINE hn::Vec<Int32s> add_halves(hn::Vec<Int32s> sum, hn::Vec<Int16s> halves) {
#if HWY_TARGET == HWY_NEON
  return hn::Vec<Int32s>(vpadalq_s16(sum.raw, halves.raw));
#elif HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128  // pmaddwd; elsewhere the order of its lanes is another
  hn::Vec<Int32s> unused = hn::Zero(Int32s());
  return hn::ReorderWidenMulAccumulate(Int32s(), halves, hn::Set(Int16s(), 1), sum, unused);
#else
  const auto both = hn::BitCast(Int32s(), halves);
  const auto low = hn::ShiftRight<16>(hn::ShiftLeft<16>(both));
  return hn::Add(sum, hn::Add(low, hn::ShiftRight<16>(both)));
#endif
}

// Zero in the high half of every 32-bit lane.
HWY_INLINE hn::Vec<Int16s> without_high_halves(hn::Vec<Int16s> halves) {
  return hn::And(halves, hn::BitCast(Int16s(), hn::Set(Int32s(), 0xFFFF)));
}

#endif  // HWY_TARGET != HWY_SCALAR

}  // namespace rfmvo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
