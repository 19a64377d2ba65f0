#include "edges/lcm_bus.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <lcm/lcm-cpp.hpp>

#include "edges/lcm_codec.hpp"

namespace rfmvo {
namespace {

constexpr std::string_view kUdpm = "udpm://";
constexpr std::uint16_t kDefaultPort = 7667;

// The group of "udpm://GROUP[:PORT][?...]". LCM's own default where it is empty.
std::string group_of(std::string_view url) {
  const std::string_view rest = url.substr(kUdpm.size());
  const std::string group(rest.substr(0, rest.find_first_of(":?")));
  return group.empty() ? "239.255.76.67" : group;
}

// liblcm reports a missing route as several lines on stderr; ask the kernel first, by a connect()
// that sends nothing.
Status check_route(const std::string& url) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kDefaultPort);
  const std::string group = group_of(url);
  if (::inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1)
    return Error{ErrorCode::kMalformed, "\"" + group + "\" is not an IPv4 address", url};
  if (!IN_MULTICAST(ntohl(address.sin_addr.s_addr)))
    return Error{ErrorCode::kMalformed, group + " is not a multicast address (224.0.0.0 to 239.255.255.255)", url};
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return Error{ErrorCode::kUnsupported, std::string("no network socket: ") + std::strerror(errno), url};
  const int failed = ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  const int reason = errno;
  ::close(fd);
  if (failed == 0) return Done{};
  return Error{ErrorCode::kUnsupported,
               "no multicast route: " + std::string(std::strerror(reason)) +
                   "; for this machine alone: ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo",
               url};
}

}  // namespace

struct LcmBus::Impl {
  Impl(const std::string& url, std::string channel_prefix) : bus(url), prefix(std::move(channel_prefix)) {}
  lcm::LCM bus;
  std::string prefix;
};

LcmBus::LcmBus(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LcmBus::~LcmBus() = default;

Result<std::unique_ptr<LcmBus>> LcmBus::create(const std::string& url, const std::string& prefix) {
  if (url.starts_with(kUdpm))
    if (const Status route = check_route(url); !route) return route.error();
  auto impl = std::make_unique<Impl>(url, prefix);
  if (!impl->bus.good()) return Error{ErrorCode::kUnsupported, "LCM cannot open this url", url};
  return std::unique_ptr<LcmBus>(new LcmBus(std::move(impl)));
}

Status LcmBus::publish(const Estimate& estimate) {
  for (const LcmMessage& message : encode(estimate, impl_->prefix))
    if (const Status s = publish(message); !s) return s;
  return Done{};
}

Status LcmBus::publish(const LcmMessage& message) {
  const auto size = static_cast<unsigned>(message.data.size());
  if (impl_->bus.publish(message.channel, message.data.data(), size) != 0)
    return Error{ErrorCode::kUnwritable, std::string("cannot publish: ") + std::strerror(errno), message.channel};
  return Done{};
}

}  // namespace rfmvo
