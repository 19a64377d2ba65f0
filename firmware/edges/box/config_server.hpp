// Answers requests about the configuration that come from anywhere on the network: bytes in, bytes out. Reading is free
// to all; a change needs the shared key (config_seal.hpp), and without a key there are none.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "config/config.hpp"
#include "edges/box/config_seal.hpp"
#include "rfmvo/config_request_t.hpp"

namespace rfmvo {

class ConfigServer {
 public:
  struct Doors {
    std::function<Config()> running;  // what the box runs with
    // Sets one key for good: what is in force then, or why not.
    std::function<Result<Config>(const std::string& key, const std::string& value)> change;
  };
  ConfigServer(Doors doors, std::optional<Key> key, Key secret);

  // The reply to a config_request_t; nothing if it is none.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> on_request(std::span<const std::uint8_t> bytes,
                                                                    DeviceTime now);

 private:
  [[nodiscard]] Result<Config> change(const config_request_t& request, DeviceTime now);

  Doors doors_;
  std::optional<Key> key_;
  ChallengeBook challenges_;
};

}  // namespace rfmvo
