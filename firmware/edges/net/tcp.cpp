#include "edges/net/tcp.hpp"

#include <netdb.h>
#include <netinet/tcp.h>

#include <cerrno>
#include <cstring>
#include <memory>

namespace rfmvo::net {
namespace {

constexpr int kBacklog = 8;

Result<std::vector<Address>> look_up(const std::string& host, std::uint16_t port, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.empty() ? nullptr : host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) return Error{ErrorCode::kNotFound, ::gai_strerror(error), host};
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, &::freeaddrinfo);
  std::vector<Address> addresses;
  for (const addrinfo* a = list.get(); a != nullptr; a = a->ai_next) {
    Address& address = addresses.emplace_back();
    std::memcpy(&address.storage, a->ai_addr, a->ai_addrlen);
    address.size = a->ai_addrlen;
  }
  return addresses;
}

void set(const Fd& fd, int level, int option, int value) {
  (void)::setsockopt(fd.get(), level, option, &value, sizeof value);
}

Fd new_socket(const Address& address) {
  return Fd(::socket(address.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

Error system_error(ErrorCode code, const std::string& where = "") { return {code, std::strerror(errno), where}; }

const sockaddr* raw(const Address& address) { return reinterpret_cast<const sockaddr*>(&address.storage); }

}  // namespace

Result<std::vector<Address>> resolve(const std::string& host, std::uint16_t port) {
  return look_up(host, port, AI_ADDRCONFIG);
}

Result<Fd> start_connect(const Address& address) {
  Fd fd = new_socket(address);
  if (!fd.valid()) return system_error(ErrorCode::kUnreadable);
  set(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  if (::connect(fd.get(), raw(address), address.size) != 0 && errno != EINPROGRESS && errno != EINTR)
    return system_error(ErrorCode::kUnreadable);
  return fd;
}

std::string connect_failure(const Fd& fd) {
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
  return error == 0 ? "" : std::strerror(error);
}

Result<Fd> listen_on(const std::string& host, std::uint16_t port) {
  const std::string where = host + ":" + std::to_string(port);
  const auto addresses = look_up(host, port, AI_PASSIVE);
  if (!addresses) return addresses.error();
  Fd fd = new_socket(addresses.value().front());
  if (!fd.valid()) return system_error(ErrorCode::kUnreadable, where);
  set(fd, SOL_SOCKET, SO_REUSEADDR, 1);
  const Address& address = addresses.value().front();
  if (::bind(fd.get(), raw(address), address.size) != 0 || ::listen(fd.get(), kBacklog) != 0)
    return system_error(ErrorCode::kUnreadable, where);
  return fd;
}

std::uint16_t port_of(const Fd& fd) {
  Address address;
  address.size = sizeof address.storage;
  if (::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address.storage), &address.size) != 0) return 0;
  if (address.storage.ss_family == AF_INET6)
    return ntohs(reinterpret_cast<const sockaddr_in6&>(address.storage).sin6_port);
  return ntohs(reinterpret_cast<const sockaddr_in&>(address.storage).sin_port);
}

Fd accept_from(const Fd& listener) {
  Fd fd(::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (fd.valid()) set(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  return fd;
}

}  // namespace rfmvo::net
