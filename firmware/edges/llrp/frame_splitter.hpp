// A byte stream cut into whole LLRP frames, however TCP delivers it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/result.hpp"

namespace rfmvo::llrp {

class FrameSplitter {
 public:
  // The largest frame taken: capabilities of an R420 have 1.7 kB, full reports of its buffer some 64 kB.
  static constexpr std::size_t kMaxFrameBytes = std::size_t{1} << 20;

  void feed(std::span<const std::uint8_t> bytes);
  // The next whole frame, valid until the next call; nothing if it has not come yet. After an error (a header
  // that is none, a length above the limit) the stream has lost its frames for good.
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>> next();
  [[nodiscard]] bool empty() const { return begin_ == buffer_.size(); }

 private:
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
};

}  // namespace rfmvo::llrp
