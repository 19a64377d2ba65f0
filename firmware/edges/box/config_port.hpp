// The configuration's door on the LCM bus: a thread that takes CONFIG_REQUEST and answers on CONFIG_REPLY.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "edges/box/config_server.hpp"
#include "edges/device_clock.hpp"

namespace rfmvo {

class ConfigPort {
 public:
  // Errors: of the url. Urls that nobody can send to (memq, file) have no door: null.
  [[nodiscard]] static Result<std::unique_ptr<ConfigPort>> open(const std::string& url, const std::string& prefix,
                                                                std::unique_ptr<ConfigServer> server,
                                                                DeviceClockFunction clock);
  ~ConfigPort();

 private:
  struct Impl;
  explicit ConfigPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
