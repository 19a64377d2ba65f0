#include "edges/lcm_bus.hpp"

#include <gtest/gtest.h>

#include "edges/journal.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

TEST(LcmBus, PublishesEveryEstimate) {
  const testing::TemporaryFolder folder;
  const auto estimates = testing::one_of_each_estimate();
  {
    auto bus = LcmBus::create("file://" + (folder / "bus.lcmlog") + "?mode=w", "RFMVO_");
    ASSERT_TRUE(bus.ok()) << bus.error().text();
    for (const Estimate& estimate : estimates) ASSERT_TRUE(bus.value()->publish(estimate).ok());
  }
  const auto back = read_estimates(folder / "bus.lcmlog", "RFMVO_");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back.value().size(), estimates.size());
}

TEST(LcmBus, AWrongUrlIsNamed) {
  const auto error = [](const std::string& url) {
    auto bus = LcmBus::create(url, "RFMVO_");
    return bus.ok() ? "" : bus.error().text();
  };
  EXPECT_EQ(error("udpm://10.0.0.1:7667"),
            "udpm://10.0.0.1:7667: 10.0.0.1 is not a multicast address (224.0.0.0 to 239.255.255.255)");
  EXPECT_EQ(error("udpm://robot:7667"), "udpm://robot:7667: \"robot\" is not an IPv4 address");
  EXPECT_EQ(error("pigeon://x"), "pigeon://x: LCM cannot open this url");
}

}  // namespace
}  // namespace rfmvo
