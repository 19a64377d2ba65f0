#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "edges/net/channel.hpp"

namespace rfmvo::net {
namespace {

class PlainChannel : public Channel {
 public:
  explicit PlainChannel(Fd fd) : fd_(std::move(fd)) {}
  Io read(std::span<std::uint8_t> into) override {
    const ssize_t got = ::recv(fd_.get(), into.data(), into.size(), 0);
    if (got == 0 && !into.empty()) return {0, true, ""};
    return result(got);
  }
  Io write(std::span<const std::uint8_t> from) override {
    return result(::send(fd_.get(), from.data(), from.size(), MSG_NOSIGNAL));
  }
  [[nodiscard]] bool wants_write() const override { return false; }
  [[nodiscard]] int fd() const override { return fd_.get(); }

 private:
  static Io result(ssize_t count) {
    if (count >= 0) return {static_cast<std::size_t>(count), false, ""};
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return {};
    return {0, true, std::strerror(errno)};
  }
  Fd fd_;
};

}  // namespace

std::unique_ptr<Channel> plain_channel(Fd fd) { return std::make_unique<PlainChannel>(std::move(fd)); }

}  // namespace rfmvo::net
