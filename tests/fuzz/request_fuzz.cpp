// Any bytes as a request about the configuration: a reply that decodes, or none; and never a change, because nobody but
// the holder of the key can seal one.
#include <cstdlib>

#include "edges/box/config_server.hpp"
#include "rfmvo/config_reply_t.hpp"

using namespace rfmvo;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void ask(ConfigServer& server, std::span<const std::uint8_t> bytes, bool must_answer) {
  const auto answer = server.on_request(bytes, DeviceTime{1'700'000'000'000'000'000});
  require(answer.has_value() || !must_answer);
  if (!answer) return;
  config_reply_t reply;
  require(reply.decode(answer->data(), 0, static_cast<int>(answer->size())) == static_cast<int>(answer->size()));
  require((reply.ok != 0) == reply.error.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ConfigServer server(
      {[] { return Config{}; }, [](const std::string&, const std::string&) -> Result<Config> { std::abort(); }},
      Key(32, 7), Key(32, 9));
  ask(server, {data, size}, false);
  // The fingerprint is where random bytes fail first: as a request that is one.
  if (size < 3) return 0;
  static constexpr const char* kVerbs[] = {"list", "get", "challenge", "set"};
  config_request_t request{};
  request.verb = kVerbs[data[0] % 4];
  const std::size_t split = std::min<std::size_t>(data[1], size - 2);
  const auto text = [](const std::uint8_t* from, std::size_t count) {
    return std::string(std::string(reinterpret_cast<const char*>(from), count).c_str());
  };
  request.key = text(data + 2, split);
  request.value = text(data + 2 + split, size - 2 - split);
  for (std::size_t i = 0; i < sizeof(request.mac); ++i) request.mac[i] = data[i % size];
  for (std::size_t i = 0; i < sizeof(request.challenge); ++i) request.challenge[i] = data[(i + 5) % size];
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(request.getEncodedSize()));
  (void)request.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  ask(server, bytes, bytes.size() <= 4096);
  return 0;
}
