// Runs a check on every instruction set that the kernels are compiled for and this machine has.
#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "kernels/targets.hpp"  // before Highway: chooses the same sets

namespace rfmvo::testing {

template <class Check>
void for_each_target(const Check& check) {
#ifdef HWY_COMPILE_ONLY_STATIC
  check();  // the only one
#else
  const std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
  ASSERT_NE(targets, 0);
  for (std::int64_t left = targets; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
#endif
}

}  // namespace rfmvo::testing
