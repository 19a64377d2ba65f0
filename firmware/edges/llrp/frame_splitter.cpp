#include "edges/llrp/frame_splitter.hpp"

#include "edges/llrp/codec.hpp"

namespace rfmvo::llrp {

void FrameSplitter::feed(std::span<const std::uint8_t> bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

Result<std::optional<std::span<const std::uint8_t>>> FrameSplitter::next() {
  using Frame = std::optional<std::span<const std::uint8_t>>;
  const auto left = std::span<const std::uint8_t>(buffer_).subspan(begin_);
  if (left.size() < kHeaderBytes) return Frame{};
  const auto header = decode_header(left);
  if (!header) return header.error();
  const std::size_t length = header.value().length;
  if (length > kMaxFrameBytes)
    return Error{ErrorCode::kMalformed, "a frame of " + std::to_string(length) + " bytes is too long", "header"};
  if (left.size() < length) return Frame{};
  begin_ += length;
  return Frame{left.first(length)};
}

}  // namespace rfmvo::llrp
