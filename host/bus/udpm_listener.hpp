// A socket of our own on an LCM UDP multicast group.
#pragma once

#include <netinet/in.h>

#include "bus/bus_listener.hpp"
#include "bus/udpm_decoder.hpp"

namespace rfmvo {

// "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=..."; parts that are missing are LCM's defaults.
struct UdpmUrl {
  in_addr group{};
  std::uint16_t port = 7667;
  int receive_buffer_bytes = 8 << 20;  // as much of it as the machine allows
};
[[nodiscard]] Result<UdpmUrl> parse_udpm_url(const std::string& url);

class UdpmListener : public BusListener {
 public:
  [[nodiscard]] static Result<std::unique_ptr<BusListener>> create(const std::string& url);
  ~UdpmListener() override;
  UdpmListener(const UdpmListener&) = delete;
  UdpmListener& operator=(const UdpmListener&) = delete;

  [[nodiscard]] Result<std::optional<BusMessage>> next(Duration timeout) override;
  [[nodiscard]] BusLoss loss() const override { return {true, decoder_.lost(), dropped_here_}; }

 private:
  UdpmListener(int socket, std::string url);

  int socket_;
  std::string url_;
  UdpmDecoder decoder_;
  std::uint64_t dropped_here_ = 0;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace rfmvo
