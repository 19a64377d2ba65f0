// The other end of a box's configuration: asks over LCM and waits for the answer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edges/box/config_seal.hpp"

namespace rfmvo {

struct Setting {
  std::string key, value, unit, doc;
  bool live = false;
};

class ConfigClient {
 public:
  // Errors: of the url.
  [[nodiscard]] static Result<std::unique_ptr<ConfigClient>> open(const std::string& url, const std::string& prefix);
  ~ConfigClient();

  // Errors: no box answers within two seconds; what the box says.
  [[nodiscard]] Result<std::vector<Setting>> list();
  [[nodiscard]] Result<Setting> get(const std::string& key);
  // What the box has read back.
  [[nodiscard]] Result<Setting> set(const Key& seal, const std::string& key, const std::string& value);

 private:
  struct Impl;
  explicit ConfigClient(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
