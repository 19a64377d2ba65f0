// LCM's UDP protocol: datagrams made here from its description, and by liblcm itself on a real socket.
#include "bus/udpm_decoder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "bus/udpm_listener.hpp"

namespace rfmvo {
namespace {

using Datagram = std::vector<std::uint8_t>;

void put(Datagram& out, std::uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void put(Datagram& out, const std::string& channel) {
  out.insert(out.end(), channel.begin(), channel.end());
  out.push_back(0);
}

Datagram small(std::uint32_t sequence, const std::string& channel, const Datagram& data) {
  Datagram out;
  put(out, 0x4C433032, 4);
  put(out, sequence, 4);
  put(out, channel);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

std::vector<Datagram> fragments(std::uint32_t sequence, const std::string& channel, const Datagram& data,
                                std::size_t piece) {
  const std::size_t count = (data.size() + piece - 1) / piece;
  std::vector<Datagram> all;
  for (std::size_t i = 0; i < count; ++i) {
    Datagram out;
    put(out, 0x4C433033, 4);
    put(out, sequence, 4);
    put(out, static_cast<std::uint32_t>(data.size()), 4);
    put(out, static_cast<std::uint32_t>(i * piece), 4);
    put(out, static_cast<std::uint32_t>(i), 2);
    put(out, static_cast<std::uint32_t>(count), 2);
    if (i == 0) put(out, channel);
    const auto begin = data.begin() + static_cast<std::ptrdiff_t>(i * piece);
    out.insert(out.end(), begin, i + 1 < count ? begin + static_cast<std::ptrdiff_t>(piece) : data.end());
    all.push_back(out);
  }
  return all;
}

Datagram random_data(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Datagram data(size);
  for (auto& byte : data) byte = static_cast<std::uint8_t>(random());
  return data;
}

TEST(UdpmDecoder, ASmallMessageIsWhatWasSent) {
  UdpmDecoder decoder;
  const auto message = decoder.on(1, small(0, "ROBOT", {1, 2, 3}));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel, "ROBOT");
  EXPECT_EQ(message->data, (Datagram{1, 2, 3}));
  EXPECT_EQ(decoder.lost(), 0u);
}

TEST(UdpmDecoder, FragmentsMakeTheMessageInWhateverOrderTheyCome) {
  std::mt19937_64 random(5);
  const Datagram data = random_data(10'000, 1);
  for (int trial = 0; trial < 20; ++trial) {
    UdpmDecoder decoder;
    auto pieces = fragments(7, "FRAME", data, 1'000);
    std::shuffle(pieces.begin(), pieces.end(), random);
    std::optional<BusMessage> message;
    for (const Datagram& piece : pieces) {
      EXPECT_FALSE(message) << "before the last piece";
      message = decoder.on(1, piece);
    }
    ASSERT_TRUE(message);
    EXPECT_EQ(message->channel, "FRAME");
    EXPECT_EQ(message->data, data);
  }
}

// Whatever is thrown away: what came and what is called lost make up what was sent, between the first and the last.
TEST(UdpmDecoder, ReceivedAndLostAreAllThatWasSent) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 50; ++trial) {
    UdpmDecoder decoder;
    std::uint64_t received = 0;
    constexpr std::uint32_t kSent = 300;
    for (std::uint32_t sequence = 0; sequence < kSent; ++sequence) {
      std::vector<Datagram> datagrams = {small(sequence, "A", {1})};
      if (sequence % 3 == 1) datagrams = fragments(sequence, "B", random_data(3'000, sequence), 1'000);
      const bool end = sequence == 0 || sequence + 1 == kSent;
      for (const Datagram& datagram : datagrams)
        if (end || random() % 10 != 0) received += decoder.on(42, datagram) ? 1 : 0;
    }
    EXPECT_LT(received, kSent);
    EXPECT_EQ(received + decoder.lost(), kSent);
  }
}

TEST(UdpmDecoder, SendersAreCountedEachOnItsOwn) {
  UdpmDecoder decoder;
  for (std::uint32_t sequence = 0; sequence < 10; ++sequence) {
    EXPECT_TRUE(decoder.on(1, small(sequence, "A", {})));
    EXPECT_TRUE(decoder.on(2, small(5'000 + sequence, "B", {})));
  }
  EXPECT_EQ(decoder.lost(), 0u);
}

TEST(UdpmDecoder, ADatagramThatWasOvertakenIsNotLost) {
  UdpmDecoder decoder;
  for (const std::uint32_t sequence : {10u, 12u, 11u, 13u}) EXPECT_TRUE(decoder.on(1, small(sequence, "A", {})));
  EXPECT_EQ(decoder.lost(), 0u);
}

TEST(UdpmDecoder, ASenderThatBeganAnewLostNothing) {
  UdpmDecoder decoder;
  for (const std::uint32_t sequence : {9'998u, 9'999u, 0u, 1u, 2u})
    EXPECT_TRUE(decoder.on(1, small(sequence, "A", {})));
  EXPECT_EQ(decoder.lost(), 0u);
}

TEST(UdpmDecoder, NumbersWrapAround) {
  UdpmDecoder decoder;
  for (const std::uint32_t sequence : {0xFFFFFFFEu, 0xFFFFFFFFu, 0u, 2u})
    EXPECT_TRUE(decoder.on(1, small(sequence, "A", {})));
  EXPECT_EQ(decoder.lost(), 1u);
}

TEST(UdpmDecoder, GarbageIsNoMessageAndNoLoss) {
  std::mt19937_64 random(3);
  UdpmDecoder decoder;
  for (int trial = 0; trial < 20'000; ++trial) {
    Datagram datagram = random_data(random() % 64, random());
    if (datagram.size() >= 4 && trial % 2 == 0) {
      const std::uint32_t magic = trial % 4 == 0 ? 0x4C433032 : 0x4C433033;
      for (int i = 0; i < 4; ++i)
        datagram[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(magic >> (8 * (3 - i)));
    }
    const auto message = decoder.on(random(), datagram);
    if (message) {
      EXPECT_LE(message->channel.size(), 63u);
    }
  }
}

TEST(UdpmUrl, PartsAndWhatIsWrongWithThem) {
  const auto whole = parse_udpm_url("udpm://239.1.2.3:7001?ttl=1&recv_buf_size=1000");
  ASSERT_TRUE(whole.ok());
  EXPECT_EQ(whole.value().port, 7001);
  EXPECT_EQ(whole.value().receive_buffer_bytes, 1000);
  EXPECT_EQ(parse_udpm_url("udpm://").value().port, 7667);
  EXPECT_EQ(parse_udpm_url("udpm://10.0.0.1:7667").error().text(),
            "udpm://10.0.0.1:7667: 10.0.0.1 is not a multicast address (224.0.0.0 to 239.255.255.255)");
  EXPECT_EQ(parse_udpm_url("udpm://239.1.2.3:x").error().text(),
            "udpm://239.1.2.3:x: the port is no number from 0 to 65535");
}

}  // namespace
}  // namespace rfmvo
