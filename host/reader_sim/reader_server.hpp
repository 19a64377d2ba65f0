// A simulated reader on a TCP port, plain or by TLS; and what a network can do to its frames.
#pragma once

#include <deque>
#include <map>
#include <memory>

#include "edges/device_clock.hpp"
#include "edges/net/channel.hpp"
#include "edges/net/tcp.hpp"
#include "reader_sim/simulated_reader.hpp"

namespace rfmvo::reader_sim {

struct Delivery {
  std::size_t chunk_bytes = 0;                   // sent at a time, frames cut wherever that falls; 0: all there is
  Duration chunk_gap{0};                         // between two chunks
  std::optional<std::size_t> reset_after_bytes;  // of one connection: then RST, be it within a frame; once
};

struct ServerSettings {
  std::string host = "127.0.0.1";
  std::uint16_t port = 5084;             // 0: any free one
  std::string tls_certificate, tls_key;  // files; empty: plain
  Delivery delivery;
};

class ReaderServer {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ReaderServer>> create(const ServerSettings& settings, ReaderModel model,
                                                                    DeviceClockFunction clock);
  ~ReaderServer();

  [[nodiscard]] std::uint16_t port() const { return port_; }
  // Waits until something happens, or for `wait`, and answers it.
  void poll(Duration wait);
  [[nodiscard]] const SimulatedReader& reader() const { return reader_; }
  [[nodiscard]] std::size_t connections() const { return peers_.size(); }

  void pull_the_plug();  // all connections are reset, and nobody answers until plug_in()
  [[nodiscard]] Status plug_in();
  void reboot();  // as a reader that starts anew: forgets its ROSpec, its connections are reset

 private:
  struct Peer {
    std::unique_ptr<net::Channel> channel;
    std::deque<std::vector<std::uint8_t>> frames;  // to send
    std::size_t sent_bytes = 0;                    // of the first frame, and in all
    std::size_t sent_in_all = 0;
    DeviceTime next_chunk{};
    bool closing = false;
    std::uint32_t watched = 0;
  };

  ReaderServer(const ServerSettings& settings, ReaderModel model, DeviceClockFunction clock);
  void accept();
  void read(int fd);
  void deliver();
  bool deliver(int fd, Peer& peer);  // false: the peer is gone
  bool send_chunk(Peer& peer, std::size_t limit);
  void watch(int fd, Peer& peer);
  void reset(int fd);
  void reset_all();

  ServerSettings settings_;
  DeviceClockFunction clock_;
  SimulatedReader reader_;
  std::optional<net::TlsContext> tls_;
  net::Fd epoll_, listener_;
  std::uint16_t port_ = 0;
  std::map<int, Peer> peers_;  // by file descriptor
  bool reset_done_ = false;
};

}  // namespace rfmvo::reader_sim
