// Frames of the LLRP test data (see RFMVO_TEST_DATA/README.md).
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "edges/llrp/codec.hpp"

namespace rfmvo::testing {

using Frame = std::vector<std::uint8_t>;

[[nodiscard]] inline std::string llrp_data(const std::string& name) {
  return std::string(RFMVO_TEST_DATA) + "/llrp/" + name;
}

[[nodiscard]] inline Frame bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The frames in a file, by their length fields alone.
[[nodiscard]] inline std::vector<Frame> frames_of(const std::string& path) {
  const Frame bytes = bytes_of(path);
  std::vector<Frame> frames;
  for (std::size_t at = 0; at + llrp::kHeaderBytes <= bytes.size();) {
    std::size_t length = 0;
    for (std::size_t i = 2; i < 6; ++i) length = length << 8 | bytes[at + i];
    if (length < llrp::kHeaderBytes || at + length > bytes.size()) break;
    frames.emplace_back(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                        bytes.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
  }
  return frames;
}

// "30 34 ..." or "3034...": bytes.
[[nodiscard]] inline Frame from_hex(const std::string& hex) {
  Frame bytes;
  std::string digits;
  for (const char c : hex)
    if (c != ' ') digits += c;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

}  // namespace rfmvo::testing
