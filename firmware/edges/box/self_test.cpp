#include "edges/box/self_test.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <ctime>
#include <filesystem>

#include "edges/camera/open_camera.hpp"
#include "edges/lcm_bus.hpp"
#include "edges/net/tcp.hpp"

namespace rfmvo {
namespace {

constexpr int kConnectWithin_ms = 2000;
constexpr Duration kPictureWithin{3'000'000'000};
constexpr std::uint16_t kPlainPort = 5084, kTlsPort = 5085;  // IANA: llrp, encrypted-llrp
constexpr std::int64_t kLittleDisk_bytes = 100'000'000;

std::string date_of(std::int64_t s) {
  const auto seconds = static_cast<std::time_t>(s);
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  (void)std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &utc);
  return text.data();
}

// Why nobody answers there; empty: somebody does.
std::string knock(const net::Address& address) {
  auto fd = net::start_connect(address);
  if (!fd) return fd.error().what;
  pollfd decided{fd.value().get(), POLLOUT, 0};
  if (::poll(&decided, 1, kConnectWithin_ms) <= 0) return "no answer within 2 s";
  return net::connect_failure(fd.value());
}

}  // namespace

Check check_clock(const SystemClock& clock) {
  if (!clock.is_set()) return {"clock", false, "nobody has set it: it says " + date_of(clock.s)};
  return {"clock", true, clock.synchronised ? "set by a time server" : "set, but not by a time server"};
}

Check check_bus(const LcmConfig& config) {
  const auto bus = LcmBus::create(config.url, config.prefix);
  return bus ? Check{"bus", true, config.url} : Check{"bus", false, bus.error().text()};
}

Check check_journal(const JournalConfig& config) {
  if (config.directory.empty()) return {"journal", true, "off"};
  std::error_code error;
  std::filesystem::create_directories(config.directory, error);
  if (error || ::access(config.directory.c_str(), W_OK) != 0)
    return {"journal", false, config.directory + ": cannot be written"};
  const std::int64_t free = disk_free_bytes(config.directory).value_or(0);
  return {"journal", free >= kLittleDisk_bytes,
          config.directory + ", " + std::to_string(free / 1'000'000) + " MB free"};
}

Check check_camera(const CameraConfig& config) {
  if (!is_camera(config.source))
    return {"camera", !config.source.empty(), config.source.empty() ? "camera.source is not set" : config.source};
  auto camera = make_camera(config);
  if (!camera) return {"camera", false, camera.error().text()};
  auto mode = camera.value()->start(config);
  if (!mode) return {"camera", false, mode.error().text()};
  auto picture = camera.value()->next(kPictureWithin);
  camera.value()->stop();
  if (!picture) return {"camera", false, picture.error().text()};
  if (!picture.value()) return {"camera", false, mode.value().text + ": no picture within 3 s"};
  std::string text = mode.value().text;
  for (const std::string& note : mode.value().notes) text += "; " + note;
  return {"camera", true, text};
}

Check check_reader(const ReaderConfig& config) {
  if (config.address.empty()) return {"reader", true, "none"};
  const auto port = config.port != 0 ? static_cast<std::uint16_t>(config.port) : config.tls ? kTlsPort : kPlainPort;
  const auto addresses = net::resolve(config.address, port);
  if (!addresses) return {"reader", false, addresses.error().text()};
  const std::string where = config.address + " port " + std::to_string(port);
  std::string why = "has no address";
  for (const net::Address& address : addresses.value()) {
    why = knock(address);
    if (why.empty()) return {"reader", true, where};
  }
  return {"reader", false, where + ": " + why};
}

std::vector<Check> self_test(const Config& config) {
  return {check_clock(system_clock()), check_bus(config.lcm), check_journal(config.journal),
          check_camera(config.camera), check_reader(config.reader)};
}

}  // namespace rfmvo
