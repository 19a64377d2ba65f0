// Any bytes as a frame, and any bytes as what a reader sends to the client.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "edges/llrp/reader_session.hpp"

using namespace rfmvo;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

// What decodes is written to a frame that decodes to the same, unless something unknown was left out.
void decode_and_encode(std::span<const std::uint8_t> bytes) {
  const auto decoded = llrp::decode(bytes);
  if (!decoded) return require(!decoded.error().text().empty());
  const auto again = llrp::encode(decoded.value().message);
  const auto twice = llrp::decode(again);
  require(twice.ok() && twice.value().skipped.empty());
  require(llrp::encode(twice.value().message) == again);
}

// The reader greets, then says what it likes, in pieces; the client must only ever shrug.
void talk(std::span<const std::uint8_t> bytes) {
  llrp::ReaderSession session({}, 1);
  DeviceTime now{1'700'000'000'000'000'000};
  session.granted(now);
  session.on_connected(now);
  llrp::ReaderEventNotificationData greeting;
  greeting.timestamp = llrp::UTCTimestamp{1'700'000'000'000'000};
  greeting.connection_attempt_event = llrp::ConnectionAttemptEvent{0};
  session.on_bytes(now, llrp::encode({1, llrp::ReaderEventNotification{greeting}}));
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(1 + bytes[at] % 64U, bytes.size() - at);
    session.on_bytes(now, bytes.subspan(at, size));
    now = now + Duration{static_cast<std::int64_t>(bytes[at]) * 10'000'000};
    session.on_time(now);
    (void)session.take_output();
    (void)session.take_events();
    at += size;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  decode_and_encode(bytes);
  if (size >= llrp::kHeaderBytes) {  // the length is where random bytes fail first: put it right
    std::vector<std::uint8_t> frame(bytes.begin(), bytes.end());
    frame[0] = static_cast<std::uint8_t>(0x04 | (frame[0] & 3));
    for (std::size_t i = 0; i < 4; ++i) frame[2 + i] = static_cast<std::uint8_t>(size >> (24 - 8 * i));
    decode_and_encode(frame);
    talk(frame);
  }
  talk(bytes);
  return 0;
}
