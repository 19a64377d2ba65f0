// A reader over TCP, plain or by TLS: gives ReaderSession its socket and its clock.
#pragma once

#include <memory>

#include "edges/device_clock.hpp"
#include "edges/llrp/reader_session.hpp"
#include "edges/net/channel.hpp"
#include "edges/net/tcp.hpp"
#include "edges/reader.hpp"

namespace rfmvo::llrp {

class ReaderLink : public Reader {
 public:
  // Errors: TLS files; a reader that is not there is none.
  [[nodiscard]] static Result<std::unique_ptr<ReaderLink>> create(const ReaderSettings& settings,
                                                                  DeviceClockFunction clock, std::uint64_t seed);
  ~ReaderLink() override;

  [[nodiscard]] std::vector<Event> poll(Duration wait) override;
  void wake() override;
  void stop() override;
  [[nodiscard]] const ReaderSession& session() const { return session_; }

 private:
  ReaderLink(const ReaderSettings& settings, DeviceClockFunction clock, std::uint64_t seed);
  void follow_wishes();
  void connect();
  void connect_next(const std::string& last_failure);
  void close();
  void wait_for(Duration wait);
  void read();
  void write();
  void watch();

  ReaderSettings settings_;
  DeviceClockFunction clock_;
  ReaderSession session_;
  std::optional<net::TlsContext> tls_;
  net::Fd epoll_, wake_;
  std::vector<net::Address> addresses_;  // not tried yet
  net::Fd connecting_;                   // until it is decided
  std::unique_ptr<net::Channel> channel_;
  std::vector<std::uint8_t> input_;   // scratch
  std::vector<std::uint8_t> output_;  // not sent yet
  std::uint32_t watched_ = 0;         // epoll events asked for
};

}  // namespace rfmvo::llrp
