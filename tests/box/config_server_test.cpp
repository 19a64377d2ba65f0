// The configuration from afar: who may read, who may write, and what of it stays.
#include "edges/box/config_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <random>

#include "config/config_table.hpp"
#include "edges/box/settings_file.hpp"
#include "edges/toml_files.hpp"
#include "rfmvo/config_reply_t.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_file;

constexpr std::int64_t kSecond = 1'000'000'000;
const Key kKey(32, 7), kOtherKey(32, 8);

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x", byte);
    text += digits;
  }
  return text;
}

// RFC 4231, test cases 1, 2 and 6.
TEST(HmacSha256, IsThatOfTheStandard) {
  const auto bytes = [](std::string_view text) { return std::vector<std::uint8_t>(text.begin(), text.end()); };
  EXPECT_EQ(hex(hmac_sha256(Key(20, 0x0b), bytes("Hi There"))),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
  EXPECT_EQ(hex(hmac_sha256(bytes("Jefe"), bytes("what do ya want for nothing?"))),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  EXPECT_EQ(hex(hmac_sha256(Key(131, 0xaa), bytes("Test Using Larger Than Block-Size Key - Hash Key First"))),
            "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
}

struct ConfigServerTest : ::testing::Test {
  config_reply_t ask(ConfigServer& server, const config_request_t& request) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(request.getEncodedSize()));
    request.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    last_request = bytes;
    return reply_to(server, bytes);
  }
  config_reply_t reply_to(ConfigServer& server, const std::vector<std::uint8_t>& bytes) {
    const auto answer = server.on_request(bytes, now);
    config_reply_t reply{};
    EXPECT_TRUE(answer.has_value());
    if (answer) {
      EXPECT_GT(reply.decode(answer->data(), 0, static_cast<int>(answer->size())), 0);
    }
    return reply;
  }
  config_reply_t ask(ConfigServer& server, const std::string& verb, const std::string& key = "") {
    config_request_t request{};
    request.id = ++id;
    request.verb = verb;
    request.key = key;
    return ask(server, request);
  }
  config_request_t sealed(ConfigServer& server, const Key& key, const std::string& name, const std::string& value) {
    const config_reply_t challenge = ask(server, "challenge");
    config_request_t request{};
    request.id = ++id;
    request.verb = "set";
    request.key = name;
    request.value = value;
    Challenge given{};
    std::copy(std::begin(challenge.challenge), std::end(challenge.challenge), given.begin());
    std::copy(given.begin(), given.end(), std::begin(request.challenge));
    const Mac mac = seal_change(key, given, name, value);
    std::copy(mac.begin(), mac.end(), std::begin(request.mac));
    return request;
  }
  ConfigServer with(std::optional<Key> key) {
    return ConfigServer({[this] { return config; },
                         [this](const std::string& name, const std::string& value) -> Result<Config> {
                           Config changed = config;
                           if (const Status s = set_value_from_text(changed, name, value); !s) return s.error();
                           config = changed;
                           ++changes;
                           return config;
                         }},
                        std::move(key), Key(32, 99));
  }

  Config config;
  DeviceTime now{1'700'000'000 * kSecond};
  int changes = 0;
  std::int64_t id = 0;
  std::vector<std::uint8_t> last_request;
};

TEST_F(ConfigServerTest, AnybodyMayReadEverySetting) {
  ConfigServer server = with(std::nullopt);
  const config_reply_t all = ask(server, "list");
  ASSERT_TRUE(all.ok);
  ASSERT_EQ(static_cast<std::size_t>(all.count), config_rows().size());
  for (std::size_t i = 0; i < config_rows().size(); ++i) EXPECT_EQ(all.rows[i].key, config_rows()[i].key);
  const config_reply_t one = ask(server, "get", "camera.width_px");
  ASSERT_EQ(one.count, 1);
  EXPECT_EQ(one.rows[0].value, "640");
  EXPECT_EQ(one.rows[0].unit, "px");
  EXPECT_EQ(one.id, id);
  EXPECT_THAT(ask(server, "get", "camera.witdh_px").error, HasSubstr("did you mean camera.width_px?"));
  EXPECT_FALSE(ask(server, "dance").ok);
}

TEST_F(ConfigServerTest, WhoHasTheKeyMayWrite) {
  ConfigServer server = with(kKey);
  const config_reply_t reply = ask(server, sealed(server, kKey, "reader.power_dbm", "27.5"));
  EXPECT_TRUE(reply.ok) << reply.error;
  EXPECT_EQ(config.reader.power_dbm, 27.5);
  ASSERT_EQ(reply.count, 1);
  EXPECT_EQ(reply.rows[0].value, "27.5") << "read back";
}

TEST_F(ConfigServerTest, NobodyElseMay) {
  ConfigServer closed = with(std::nullopt);
  EXPECT_THAT(ask(closed, sealed(closed, kKey, "reader.power_dbm", "27")).error, HasSubstr("no changes from afar"));
  ConfigServer server = with(kKey);
  EXPECT_THAT(ask(server, sealed(server, kOtherKey, "reader.power_dbm", "27")).error, HasSubstr("not sealed"));
  ConfigServer other = with(kKey);
  ConfigServer stranger({[] { return Config{}; }, nullptr}, kKey, Key(32, 1));
  EXPECT_FALSE(ask(server, sealed(stranger, kKey, "reader.power_dbm", "27")).ok) << "a challenge of another box";
  EXPECT_EQ(changes, 0);
}

TEST_F(ConfigServerTest, EveryBitOfAChangeIsSealed) {
  ConfigServer server = with(kKey);
  (void)ask(server, "challenge");
  const config_request_t good = sealed(server, kKey, "reader.power_dbm", "27");
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(good.getEncodedSize()));
  good.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  const std::size_t behind_id = 16;  // fingerprint and id: the id is only echoed
  for (std::size_t bit = 8 * behind_id; bit < 8 * bytes.size(); ++bit) {
    auto changed = bytes;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    (void)server.on_request(changed, now);
    ASSERT_EQ(changes, 0) << "bit " << bit;
  }
  EXPECT_TRUE(reply_to(server, bytes).ok) << "and none of these used the challenge up";
}

TEST_F(ConfigServerTest, ARecordedChangeIsWorthNothing) {
  ConfigServer server = with(kKey);
  const config_request_t request = sealed(server, kKey, "reader.power_dbm", "27");
  EXPECT_TRUE(ask(server, request).ok);
  for (const std::int64_t later_s : {0, 1, 29, 31, 3600}) {
    now = now + Duration{later_s * kSecond};
    EXPECT_THAT(ask(server, request).error, HasSubstr("used up or too old"));
  }
  EXPECT_EQ(changes, 1);
}

TEST_F(ConfigServerTest, AChallengeGrowsOldAndManyDoNotDisplaceOne) {
  ConfigServer server = with(kKey);
  const config_request_t request = sealed(server, kKey, "reader.power_dbm", "27");
  for (int k = 0; k < 10'000; ++k) (void)ask(server, "challenge");
  EXPECT_TRUE(ask(server, request).ok);
  const config_request_t late = sealed(server, kKey, "reader.power_dbm", "28");
  now = now + Duration{31 * kSecond};
  EXPECT_FALSE(ask(server, late).ok);
}

TEST_F(ConfigServerTest, AValueThatTheTableRefusesIsNotSet) {
  ConfigServer server = with(kKey);
  EXPECT_THAT(ask(server, sealed(server, kKey, "reader.power_dbm", "99")).error, HasSubstr("outside 0 to 36 dBm"));
  EXPECT_THAT(ask(server, sealed(server, kKey, "reader.powr_dbm", "9")).error, HasSubstr("did you mean"));
  EXPECT_EQ(changes, 0);
}

TEST_F(ConfigServerTest, NoiseIsNotAnswered) {
  ConfigServer server = with(kKey);
  (void)ask(server, "list");
  const auto good = last_request;
  std::mt19937 random(3);
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(server.on_request(std::span(good).first(size), now)) << "cut short";
  for (int k = 0; k < 2000; ++k) {
    std::vector<std::uint8_t> noise(random() % 300);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    EXPECT_FALSE(server.on_request(noise, now));
  }
  std::vector<std::uint8_t> long_one = good;
  long_one.resize(100'000);
  EXPECT_FALSE(server.on_request(long_one, now));
}

TEST(KeyFile, MustBeLongAndPrivate) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& content, mode_t mode) {
    write_file(folder / "key", content);
    ::chmod((folder / "key").c_str(), mode);
    const auto key = read_key(folder / "key");
    return key.ok() ? std::string() : key.error().what;
  };
  EXPECT_EQ(error_of("0123456789abcdef\n", 0640), "");
  EXPECT_THAT(error_of("0123456789abcde\n", 0600), HasSubstr("shorter than 16 bytes"));
  EXPECT_THAT(error_of("0123456789abcdef\n", 0644), HasSubstr("everybody may"));
  EXPECT_FALSE(read_key(folder / "absent").ok());
}

TEST(SettingsFile, LiesOverTheConfigurationAndHoldsOnlyWhatWasSet) {
  const TemporaryFolder folder;
  const SettingsFile settings(folder / "settings.toml");
  Config base;
  base.reader.address = "10.0.0.5";
  ASSERT_TRUE(settings.over(base).ok());
  const auto first = settings.set(base, "reader.power_dbm", "27.5");
  ASSERT_TRUE(first.ok()) << first.error().text();
  const auto second = settings.set(base, "camera.flip", "both");
  ASSERT_TRUE(second.ok());
  EXPECT_EQ(second.value().reader.power_dbm, 27.5) << "what was set before stays";
  EXPECT_EQ(second.value().camera.flip, "both");
  EXPECT_EQ(second.value().reader.address, "10.0.0.5");
  EXPECT_EQ(
      testing::read_file(folder / "settings.toml"),
      "# Set at run time, over the configuration file.\n\n[camera]\nflip = \"both\"\n\n[reader]\npower_dbm = 27.5\n");
  base.reader.address = "10.0.0.6";  // its owner edits the file: that counts
  EXPECT_EQ(settings.over(base).value().reader.address, "10.0.0.6");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"settings.toml"}) << "nothing half-written";
}

TEST(SettingsFile, RefusesAndKeepsWhatItHad) {
  const TemporaryFolder folder;
  const SettingsFile settings(folder / "settings.toml");
  ASSERT_TRUE(settings.set({}, "camera.crop_x_px", "600").ok());
  const std::string before = testing::read_file(folder / "settings.toml");
  EXPECT_FALSE(settings.set({}, "camera.width_px", "500").ok()) << "the crop would reach beyond";
  EXPECT_FALSE(settings.set({}, "camera.width_px", "wide").ok());
  EXPECT_FALSE(settings.set({}, "camera.widht_px", "500").ok());
  EXPECT_EQ(testing::read_file(folder / "settings.toml"), before);
  EXPECT_FALSE(SettingsFile("/nowhere/settings.toml").set({}, "camera.width_px", "500").ok());
  EXPECT_FALSE(SettingsFile("").set({}, "camera.width_px", "500").ok());
}

TEST(SettingsFile, EverySettingGoesThereAndBack) {
  const TemporaryFolder folder;
  const SettingsFile settings(folder / "settings.toml");
  Config base;
  base.camera.width_px = base.camera.height_px = 8192;  // room for any crop
  for (const ConfigRow& row : config_rows()) {
    std::string value = text_of(get_value(base, row));
    if (std::holds_alternative<ConfigRow::Flag>(row.member)) value = value == "true" ? "false" : "true";
    if (std::holds_alternative<ConfigRow::Text>(row.member))
      value =
          row.choices.empty() ? "a \"quoted\" \\ text" : std::string(row.choices.substr(row.choices.rfind('|') + 1));
    const auto set = settings.set(base, row.key, value);
    ASSERT_TRUE(set.ok()) << row.key << " " << set.error().text();
    EXPECT_EQ(text_of(get_value(set.value(), row)), value) << row.key;
  }
}

}  // namespace
}  // namespace rfmvo
