#include "bus/udpm_listener.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>

namespace rfmvo {
namespace {

constexpr std::string_view kScheme = "udpm://";
constexpr std::size_t kMaxDatagram = 65'536;

template <class Number>
bool read_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

Error trouble(const char* what, const std::string& url) {
  return {ErrorCode::kUnsupported, std::string(what) + ": " + std::strerror(errno), url};
}

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

bool set(int fd, int level, int option, int value) {
  return ::setsockopt(fd, level, option, &value, sizeof value) == 0;
}

// Other LCM programs listen on the same port of this machine.
Status prepare(int fd, const UdpmUrl& url, const std::string& text) {
  if (!set(fd, SOL_SOCKET, SO_REUSEADDR, 1) || !set(fd, SOL_SOCKET, SO_REUSEPORT, 1))
    return trouble("the port cannot be shared", text);
  // Beyond the machine's limit only root may go; the limit is what remains.
  if (!set(fd, SOL_SOCKET, SO_RCVBUFFORCE, url.receive_buffer_bytes))
    (void)set(fd, SOL_SOCKET, SO_RCVBUF, url.receive_buffer_bytes);
  (void)set(fd, SOL_SOCKET, SO_RXQ_OVFL, 1);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url.port);
  address.sin_addr = url.group;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return trouble("cannot be listened to", text);
  const ip_mreqn group{url.group, {htonl(INADDR_ANY)}, 0};
  if (::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0)
    return trouble(
        "no multicast route (for this machine alone: ip link set lo multicast on; "
        "ip route add 224.0.0.0/4 dev lo)",
        text);
  return Done{};
}

// How many datagrams the kernel has thrown away for this socket, so far; 0 if it does not say.
std::uint32_t dropped_of(msghdr& message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t dropped = 0;
    std::memcpy(&dropped, CMSG_DATA(c), sizeof dropped);
    return dropped;
  }
  return 0;
}

}  // namespace

Result<UdpmUrl> parse_udpm_url(const std::string& url) {
  UdpmUrl parsed;
  const std::string_view rest = std::string_view(url).substr(kScheme.size());
  const std::string_view network = rest.substr(0, rest.find('?'));
  const std::size_t colon = network.find(':');
  const std::string group(network.substr(0, colon));
  if (::inet_pton(AF_INET, group.empty() ? "239.255.76.67" : group.c_str(), &parsed.group) != 1)
    return Error{ErrorCode::kMalformed, "\"" + group + "\" is not an IPv4 address", url};
  if (!IN_MULTICAST(ntohl(parsed.group.s_addr)))
    return Error{ErrorCode::kMalformed, group + " is not a multicast address (224.0.0.0 to 239.255.255.255)", url};
  if (colon != std::string_view::npos && !read_number(network.substr(colon + 1), parsed.port))
    return Error{ErrorCode::kMalformed, "the port is no number from 0 to 65535", url};
  constexpr std::string_view kBuffer = "recv_buf_size=";
  if (const std::size_t at = rest.find(kBuffer); at != std::string_view::npos) {
    const std::string_view value = rest.substr(at + kBuffer.size());
    if (!read_number(value.substr(0, value.find('&')), parsed.receive_buffer_bytes))
      return Error{ErrorCode::kMalformed, "recv_buf_size is no number", url};
  }
  return parsed;
}

UdpmListener::UdpmListener(int socket, std::string url)
    : socket_(socket), url_(std::move(url)), buffer_(kMaxDatagram) {}

UdpmListener::~UdpmListener() { ::close(socket_); }

Result<std::unique_ptr<BusListener>> UdpmListener::create(const std::string& url) {
  const auto parsed = parse_udpm_url(url);
  if (!parsed) return parsed.error();
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return trouble("no network socket", url);
  std::unique_ptr<BusListener> listener(new UdpmListener(fd, url));
  if (const Status s = prepare(fd, parsed.value(), url); !s) return s.error();
  return listener;
}

Result<std::optional<BusMessage>> UdpmListener::next(Duration timeout) {
  const std::int64_t until_ns = monotonic_ns() + timeout.ns;
  while (true) {
    sockaddr_in from{};
    iovec part{buffer_.data(), buffer_.size()};
    alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(std::uint32_t))] = {};
    msghdr header{&from, sizeof from, &part, 1, control, sizeof control, 0};
    const ssize_t got = ::recvmsg(socket_, &header, 0);
    if (got >= 0) {
      if (const std::uint32_t dropped = dropped_of(header); dropped > 0) dropped_here_ = dropped;
      const std::uint64_t sender = std::uint64_t{from.sin_addr.s_addr} << 16 | from.sin_port;
      auto message = decoder_.on(sender, {buffer_.data(), static_cast<std::size_t>(got)});
      if (message) return message;
      continue;
    }
    if (errno == EINTR) return std::optional<BusMessage>();
    if (errno != EAGAIN && errno != EWOULDBLOCK) return trouble("cannot be listened to", url_);
    const std::int64_t left_ns = until_ns - monotonic_ns();
    if (left_ns <= 0) return std::optional<BusMessage>();
    pollfd waiting{socket_, POLLIN, 0};
    const timespec wait{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
    if (::ppoll(&waiting, 1, &wait, nullptr) < 0) return std::optional<BusMessage>();  // EINTR
  }
}

}  // namespace rfmvo
