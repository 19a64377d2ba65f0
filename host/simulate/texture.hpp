// Procedural grey textures with the corners and edges that feature trackers need.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "simulate/random.hpp"

namespace rfmvo::simulate {

// A square image of 2^bits texels that repeats, with its half-size copies for distant surfaces.
class Texture {
 public:
  Texture(int bits, const std::vector<float>& grey);  // 0..255, row by row
  [[nodiscard]] int bits() const { return bits_; }
  // Bilinear; x to the right, y down, in texels of level 0, any value (it wraps).
  [[nodiscard]] float sample(float x, float y, int level) const;

 private:
  int bits_;
  std::vector<std::vector<std::uint8_t>> levels_;
};

// std::floor is a call into the library on processors without an instruction for it.
[[nodiscard]] inline int floor_of(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

inline float Texture::sample(float x, float y, int level) const {
  level = std::clamp(level, 0, bits_);
  const int side_bits = bits_ - level, mask = (1 << side_bits) - 1;
  const std::uint8_t* texels = levels_[static_cast<std::size_t>(level)].data();
  const float scale = 1.0F / static_cast<float>(1 << level);
  // Texel centres lie at half-integers of every level.
  const float u = x * scale - 0.5F, v = y * scale - 0.5F;
  const int ui = floor_of(u), vi = floor_of(v);
  const float f = u - static_cast<float>(ui), g = v - static_cast<float>(vi);
  const int x0 = ui & mask, x1 = (x0 + 1) & mask;
  const std::uint8_t* row0 = texels + (static_cast<std::size_t>(vi & mask) << side_bits);
  const std::uint8_t* row1 = texels + (static_cast<std::size_t>((vi + 1) & mask) << side_bits);
  const float top = row0[x0] + f * static_cast<float>(row0[x1] - row0[x0]);
  const float bottom = row1[x0] + f * static_cast<float>(row1[x1] - row1[x0]);
  return top + g * (bottom - top);
}

using TexturePointer = std::shared_ptr<const Texture>;

[[nodiscard]] TexturePointer cardboard_texture(Random& random);  // tape, label with bar code, stamps
[[nodiscard]] TexturePointer concrete_texture(Random& random);   // floor: stains, chips
[[nodiscard]] TexturePointer steel_texture(Random& random);      // racks: holes, stickers
[[nodiscard]] TexturePointer clutter_texture(Random& random);    // what stands behind a shelf
[[nodiscard]] TexturePointer plaster_texture(Random& random);    // a painted wall with marks
[[nodiscard]] TexturePointer checkerboard_texture(int squares);  // squares a side
[[nodiscard]] TexturePointer label_texture(Random& random);      // an RFID inlay

}  // namespace rfmvo::simulate
