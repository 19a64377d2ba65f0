// Configuration and calibration as TOML. Unknown keys, wrong types, wrong units and values out of
// range are errors that name file, line and key.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "config/calibration.hpp"
#include "config/config.hpp"

namespace rfmvo {

// `base` is what keys that are not mentioned keep.
[[nodiscard]] Result<Config> parse_config(std::string_view toml, const std::string& where, const Config& base = {});
[[nodiscard]] Result<Config> read_config(const std::string& path, const Config& base = {});
[[nodiscard]] std::string to_toml(const Config& config);  // every key, with unit and doc as comments; parses back equal

[[nodiscard]] Result<Calibration> parse_calibration(std::string_view toml, const std::string& where);
[[nodiscard]] Result<Calibration> read_calibration(const std::string& path);
[[nodiscard]] std::string to_toml(const Calibration& calibration);

}  // namespace rfmvo
