#include "simulate/texture.hpp"

#include <algorithm>
#include <cmath>

namespace rfmvo::simulate {
namespace {

// A sheet to paint on, in fractions of its side.
class Sheet {
 public:
  Sheet(int bits, float grey) : bits_(bits), side_(1 << bits), grey_(static_cast<std::size_t>(side_) * side_, grey) {}

  void rectangle(double x0, double y0, double x1, double y1, float grey) {
    const auto [a, b] = range(x0, x1);
    const auto [c, d] = range(y0, y1);
    for (int y = c; y < d; ++y) {
      for (int x = a; x < b; ++x) at(x, y) = grey;
    }
  }

  void disc(double cx, double cy, double radius, float grey) {
    const auto [a, b] = range(cx - radius, cx + radius);
    const auto [c, d] = range(cy - radius, cy + radius);
    const double r2 = std::pow(radius * side_, 2);
    for (int y = c; y < d; ++y) {
      for (int x = a; x < b; ++x) {
        if (std::pow(x - cx * side_, 2) + std::pow(y - cy * side_, 2) < r2) at(x, y) = grey;
      }
    }
  }

  // Smooth noise on a grid of `cells` a side; it repeats with the sheet.
  void noise(int cells, float amplitude, Random& random) {
    std::vector<float> grid(static_cast<std::size_t>(cells) * cells);
    for (float& g : grid) g = static_cast<float>(random.uniform(-1.0, 1.0));
    const auto node = [&](int i, int j) { return grid[static_cast<std::size_t>((j % cells) * cells + i % cells)]; };
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        const float u = static_cast<float>(x) * cells / side_, v = static_cast<float>(y) * cells / side_;
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const float f = u - i, g = v - j;
        at(x, y) += amplitude * ((1 - f) * (1 - g) * node(i, j) + f * (1 - g) * node(i + 1, j) +
                                 (1 - f) * g * node(i, j + 1) + f * g * node(i + 1, j + 1));
      }
    }
  }

  // Rows of dark blocks that look like print.
  void print(double x0, double y0, double x1, double y1, int rows, Random& random, float grey) {
    const double pitch = (y1 - y0) / rows;
    for (int row = 0; row < rows; ++row) {
      double x = x0;
      while (x < x1) {
        const double width = random.uniform(0.2, 1.5) * pitch;
        const double y = y0 + row * pitch;
        rectangle(x, y, std::min(x + width, x1), y + pitch * 0.6, grey);
        x += width + random.uniform(0.2, 0.6) * pitch;
      }
    }
  }

  [[nodiscard]] TexturePointer texture() const { return std::make_shared<const Texture>(bits_, grey_); }

 private:
  float& at(int x, int y) { return grey_[static_cast<std::size_t>(y) * side_ + x]; }
  [[nodiscard]] std::pair<int, int> range(double from, double to) const {
    return {std::clamp(static_cast<int>(std::lround(from * side_)), 0, side_),
            std::clamp(static_cast<int>(std::lround(to * side_)), 0, side_)};
  }

  int bits_, side_;
  std::vector<float> grey_;
};

void bar_code(Sheet& sheet, double x0, double y0, double x1, double y1, Random& random) {
  for (double x = x0; x < x1;) {
    const double bar = random.uniform(0.004, 0.014);
    sheet.rectangle(x, y0, std::min(x + bar, x1), y1, 25.0F);
    x += bar + random.uniform(0.005, 0.014);
  }
}

}  // namespace

Texture::Texture(int bits, const std::vector<float>& grey) : bits_(bits) {
  std::vector<std::uint8_t> level(grey.size());
  for (std::size_t i = 0; i < grey.size(); ++i) {
    level[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey[i]), 0L, 255L));
  }
  levels_.push_back(std::move(level));
  for (int side = 1 << (bits - 1); side >= 1; side /= 2) {
    const std::vector<std::uint8_t>& big = levels_.back();
    std::vector<std::uint8_t> half;
    half.reserve(static_cast<std::size_t>(side) * side);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const std::size_t i = static_cast<std::size_t>(4 * side) * y + 2 * x;
        const std::size_t below = i + static_cast<std::size_t>(2 * side);
        half.push_back(static_cast<std::uint8_t>((big[i] + big[i + 1] + big[below] + big[below + 1] + 2) / 4));
      }
    }
    levels_.push_back(std::move(half));
  }
}

TexturePointer cardboard_texture(Random& random) {
  Sheet sheet(8, static_cast<float>(random.uniform(105, 190)));
  sheet.noise(4, 10.0F, random);
  sheet.noise(32, 7.0F, random);
  sheet.noise(128, 6.0F, random);
  sheet.rectangle(0.45, 0.0, 0.55, 1.0, static_cast<float>(random.uniform(150, 215)));  // tape
  sheet.print(random.uniform(0.05, 0.2), 0.08, random.uniform(0.5, 0.9), random.uniform(0.2, 0.3), 2, random, 60.0F);
  const double x = random.uniform(0.05, 0.45), y = random.uniform(0.35, 0.55);
  sheet.rectangle(x, y, x + 0.45, y + 0.35, 235.0F);
  bar_code(sheet, x + 0.03, y + 0.03, x + 0.42, y + 0.14, random);
  sheet.print(x + 0.03, y + 0.17, x + 0.40, y + 0.33, 4, random, 50.0F);
  for (int i = 0; i < 5; ++i) {
    const double cx = random.uniform(), cy = random.uniform(), r = random.uniform(0.01, 0.03);
    sheet.disc(cx, cy, r, static_cast<float>(random.uniform(50, 220)));
  }
  for (const double edge : {0.0, 0.985}) {
    sheet.rectangle(edge, 0, edge + 0.015, 1, 70.0F);
    sheet.rectangle(0, edge, 1, edge + 0.015, 70.0F);
  }
  return sheet.texture();
}

TexturePointer concrete_texture(Random& random) {
  Sheet sheet(10, 125.0F);
  for (int i = 0; i < 500; ++i) {
    const double x = random.uniform(), y = random.uniform(), r = random.uniform(0.001, 0.006);
    sheet.disc(x, y, r, static_cast<float>(random.uniform(50, 200)));
  }
  for (const int cells : {8, 32, 128, 512}) sheet.noise(cells, 12.0F, random);
  return sheet.texture();
}

TexturePointer steel_texture(Random& random) {
  Sheet sheet(8, static_cast<float>(random.uniform(60, 100)));
  sheet.noise(64, 8.0F, random);
  for (int hole = 0; hole < 10; ++hole) sheet.disc(0.5, (hole + 0.5) / 10, 0.02, 15.0F);
  for (int i = 0; i < 6; ++i) {
    const double x = random.uniform(0.0, 0.85), y = random.uniform(0.0, 0.9);
    sheet.rectangle(x, y, x + random.uniform(0.05, 0.15), y + random.uniform(0.03, 0.1),
                    static_cast<float>(random.uniform(120, 230)));
  }
  sheet.noise(128, 6.0F, random);
  return sheet.texture();
}

TexturePointer clutter_texture(Random& random) {
  Sheet sheet(9, 70.0F);
  for (int i = 0; i < 160; ++i) {
    const double x = random.uniform(-0.1, 1.0), y = random.uniform(-0.1, 1.0);
    const double w = random.uniform(0.03, 0.2), h = random.uniform(0.03, 0.15);
    sheet.rectangle(x, y, x + w, y + h, static_cast<float>(random.uniform(25, 130)));
  }
  sheet.noise(128, 8.0F, random);
  return sheet.texture();
}

TexturePointer plaster_texture(Random& random) {
  Sheet sheet(10, 165.0F);
  for (int i = 0; i < 2500; ++i) {
    const double x = random.uniform(), y = random.uniform(), r = random.uniform(0.001, 0.004);
    sheet.disc(x, y, r, static_cast<float>(random.uniform(70, 225)));
  }
  for (const int cells : {4, 64, 256}) sheet.noise(cells, 7.0F, random);
  return sheet.texture();
}

TexturePointer checkerboard_texture(int squares) {
  Sheet sheet(9, 235.0F);
  for (int j = 0; j < squares; ++j) {
    for (int i = j % 2; i < squares; i += 2) {
      sheet.rectangle(static_cast<double>(i) / squares, static_cast<double>(j) / squares,
                      static_cast<double>(i + 1) / squares, static_cast<double>(j + 1) / squares, 20.0F);
    }
  }
  return sheet.texture();
}

TexturePointer label_texture(Random& random) {
  Sheet sheet(6, 240.0F);
  sheet.print(0.1, 0.15, 0.9, 0.85, 5, random, 90.0F);
  return sheet.texture();
}

}  // namespace rfmvo::simulate
