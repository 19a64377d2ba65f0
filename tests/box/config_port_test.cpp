// The configuration's door on a real bus. Skips where this machine has no multicast route.
#include "edges/box/config_port.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <lcm/lcm-cpp.hpp>
#include <mutex>

#include "config/config_table.hpp"
#include "edges/box/config_client.hpp"
#include "edges/lcm_bus.hpp"
#include "rfmvo/config_reply_t.hpp"

namespace rfmvo {
namespace {

std::unique_ptr<ConfigServer> server() {
  return std::make_unique<ConfigServer>(
      ConfigServer::Doors{[] { return Config{}; },
                          [](const std::string&, const std::string&) { return Result<Config>(Config{}); }},
      std::nullopt, Key(32, 1));
}

struct Asker {
  void take(const lcm::ReceiveBuffer*, const std::string&, const config_reply_t* message) { reply = *message; }
  config_reply_t reply{};
};

TEST(ConfigPort, NobodyCanKnockWhereThereIsNoBus) {
  for (const std::string url : {"memq://", "file:///tmp/never?mode=r"}) {
    const auto port = ConfigPort::open(url, "RFMVO_", server(), device_clock());
    ASSERT_TRUE(port.ok());
    EXPECT_EQ(port.value(), nullptr);
  }
}

// Both ends, with the key and without.
TEST(ConfigClient, SetsWhatTheKeyAllows) {
  const std::string url = "udpm://239.255.76.67:" + std::to_string(40000 + ::getpid() % 20000) + "?ttl=0";
  if (!LcmBus::create(url, "RFMVO_")) GTEST_SKIP() << "no multicast route";
  std::mutex mutex;
  Config config;
  const ConfigServer::Doors doors{[&] {
                                    const std::lock_guard lock(mutex);
                                    return config;
                                  },
                                  [&](const std::string& key, const std::string& value) -> Result<Config> {
                                    const std::lock_guard lock(mutex);
                                    if (const Status s = set_value_from_text(config, key, value); !s) return s.error();
                                    return config;
                                  }};
  const Key key(32, 5), wrong(32, 6);
  auto port = ConfigPort::open(url, "RFMVO_", std::make_unique<ConfigServer>(doors, key, Key(32, 1)), device_clock());
  ASSERT_TRUE(port.ok());
  auto client = ConfigClient::open(url, "RFMVO_");
  ASSERT_TRUE(client.ok());
  const auto all = client.value()->list();
  ASSERT_TRUE(all.ok()) << all.error().text();
  EXPECT_EQ(all.value().size(), config_rows().size());
  const auto set = client.value()->set(key, "camera.exposure_s", "0.004");
  ASSERT_TRUE(set.ok()) << set.error().text();
  EXPECT_EQ(set.value().value, "0.004");
  EXPECT_TRUE(set.value().live);
  EXPECT_EQ(client.value()->get("camera.exposure_s").value().value, "0.004");
  EXPECT_EQ(client.value()->set(wrong, "camera.exposure_s", "0.005").error().text(), "not sealed with this box's key");
  EXPECT_EQ(client.value()->get("camera.exposure_s").value().value, "0.004");
}

TEST(ConfigPort, AnswersOnTheBus) {
  // A port of its own, so that tests side by side do not hear each other.
  const std::string url = "udpm://239.255.76.67:" + std::to_string(20000 + ::getpid() % 20000) + "?ttl=0";
  if (!LcmBus::create(url, "RFMVO_")) GTEST_SKIP() << "no multicast route";
  auto port = ConfigPort::open(url, "RFMVO_", server(), device_clock());
  ASSERT_TRUE(port.ok());
  ASSERT_NE(port.value(), nullptr);
  lcm::LCM bus(url);
  Asker asker;
  const config_reply_t& reply = asker.reply;
  (void)bus.subscribe("RFMVO_CONFIG_REPLY", &Asker::take, &asker);
  config_request_t request{};
  request.id = 42;
  request.verb = "get";
  request.key = "camera.width_px";
  while (reply.id != 42) {  // the other end may still be on its way
    (void)bus.publish("RFMVO_CONFIG_REQUEST", &request);
    (void)bus.handleTimeout(200);
  }
  ASSERT_EQ(reply.count, 1);
  EXPECT_EQ(reply.rows[0].value, "640");
}

}  // namespace
}  // namespace rfmvo
