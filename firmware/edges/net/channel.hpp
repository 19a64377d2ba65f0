// A connection's bytes, plain or by TLS, without ever waiting.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/result.hpp"
#include "edges/net/fd.hpp"

namespace rfmvo::net {

struct Io {
  std::size_t bytes = 0;  // that went through
  bool closed = false;    // by the peer, in order or not
  std::string error;      // why, if not in order
};

class Channel {
 public:
  virtual ~Channel() = default;
  virtual Io read(std::span<std::uint8_t> into) = 0;
  virtual Io write(std::span<const std::uint8_t> from) = 0;
  // TLS may want to write before it can read.
  [[nodiscard]] virtual bool wants_write() const = 0;
  [[nodiscard]] virtual int fd() const = 0;
};

[[nodiscard]] std::unique_ptr<Channel> plain_channel(Fd fd);

// Keys and trust of TLS; one for many connections.
class TlsContext {
 public:
  // Trusts what `ca_file` holds, by the name or address `host`; without one, whoever answers (readers carry
  // certificates of their makers): encrypted, but not authenticated.
  [[nodiscard]] static Result<TlsContext> client(const std::string& ca_file, const std::string& host);
  [[nodiscard]] static Result<TlsContext> server(const std::string& certificate_file, const std::string& key_file);
  TlsContext(TlsContext&&) noexcept;
  TlsContext& operator=(TlsContext&&) noexcept;
  ~TlsContext();

  [[nodiscard]] std::unique_ptr<Channel> channel(Fd fd) const;

 private:
  struct Impl;
  explicit TlsContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo::net
