// Non-blocking TCP over IPv4 and IPv6.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "edges/net/fd.hpp"

namespace rfmvo::net {

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
};

// Of a name or number, in the order in which they should be tried. May wait for the network's name service.
[[nodiscard]] Result<std::vector<Address>> resolve(const std::string& host, std::uint16_t port);
// Begins to connect; writable once it is decided.
[[nodiscard]] Result<Fd> start_connect(const Address& address);
// Why a decided connection failed; empty: it stands.
[[nodiscard]] std::string connect_failure(const Fd& fd);

// Port 0: any free one, see port_of.
[[nodiscard]] Result<Fd> listen_on(const std::string& host, std::uint16_t port);
[[nodiscard]] std::uint16_t port_of(const Fd& fd);
// An invalid Fd: nobody is waiting.
[[nodiscard]] Fd accept_from(const Fd& listener);

}  // namespace rfmvo::net
