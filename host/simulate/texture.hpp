// Procedural grey textures with the corners and edges that feature trackers need.
#pragma once

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

using TexturePointer = std::shared_ptr<const Texture>;

[[nodiscard]] TexturePointer cardboard_texture(Random& random);  // tape, label with bar code, stamps
[[nodiscard]] TexturePointer concrete_texture(Random& random);   // floor: stains, chips
[[nodiscard]] TexturePointer steel_texture(Random& random);      // racks: holes, stickers
[[nodiscard]] TexturePointer clutter_texture(Random& random);    // what stands behind a shelf
[[nodiscard]] TexturePointer plaster_texture(Random& random);    // a painted wall with marks
[[nodiscard]] TexturePointer checkerboard_texture(int squares);  // squares a side
[[nodiscard]] TexturePointer label_texture(Random& random);      // an RFID inlay

}  // namespace rfmvo::simulate
