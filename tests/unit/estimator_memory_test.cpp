// What an endless drive costs: no allocation per read once all has its size, and a map that stays small.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "estimator/joint_estimator.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "estimator/tag_map.hpp"

namespace {

std::atomic<std::size_t> allocations{0}, allocated_bytes{0};

}  // namespace

// Of the whole test program; but not under the sanitizer, which has its own.
#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t size) {
  ++allocations;
  allocated_bytes += size;
  void* p = std::malloc(size);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace rfmvo {
namespace {

Epc tag(std::uint32_t number) {
  char hex[25];
  std::snprintf(hex, sizeof hex, "3034257BF46DB640%08X", number);
  return Epc::from_hex(hex).value();
}

TEST(Memory, AReadAllocatesNothingInTheSteadyState) {
  Calibration calibration;
  for (std::uint8_t port = 1; port <= 2; ++port) {
    AntennaCalibration antenna;
    antenna.port = port;
    calibration.antennas.push_back(antenna);
  }
  SamplingSynchronization synchronization{Config{}};
  JointEstimator estimator(Config{}, calibration);
  constexpr std::uint32_t kTags = 5;
  std::int64_t now_ns = 0;
  std::size_t in_steady_state = 0;
  // A long stop in front of the same tags, after a short way: 40 reads/s on either port.
  for (int frame = 0; frame < 12000; ++frame) {
    now_ns += 33'333'333;
    CameraPose pose;
    pose.time = {now_ns};
    pose.status = VoStatus::kTracking;
    pose.T_V_C.p_V_C.x() = 0.01 * std::min(frame, 100);
    estimator.on(pose);
    for (const SampledRead& read : synchronization.on(pose)) estimator.on(read);
    TagRead read;
    read.epc = tag(static_cast<std::uint32_t>(frame) % kTags);
    read.time = {now_ns + 10'000'000};
    read.port = static_cast<std::uint8_t>(1 + (frame / 7) % 2);
    read.frequency_hz = 920e6;
    read.seen_count = 1;
    const std::size_t before = allocations;
    for (const SampledRead& r : synchronization.on(read)) estimator.on(r);
    if (frame > 11000) in_steady_state += allocations - before;
  }
  if (allocations == 0) GTEST_SKIP() << "allocations are not counted here";
  EXPECT_EQ(in_steady_state, 0U);
}

TEST(Memory, TenThousandTagsFitInto64Megabytes) {
  const std::size_t before = allocated_bytes;
  TagMap map(60.0);
  for (std::uint32_t i = 0; i < 10000; ++i) {
    TagEstimate e;
    e.epc = tag(i);
    e.status = TagStatus::kMirror;
    e.hypotheses.resize(8);
    map.keep(e, {});
  }
  EXPECT_EQ(map.tags().size(), 10000U);
  EXPECT_LT(allocated_bytes - before, 64U << 20);  // all that was ever asked for, so more than what is held
}

}  // namespace
}  // namespace rfmvo
