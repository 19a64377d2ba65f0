// Random numbers that are the same everywhere: std::mt19937_64 is fixed by the standard, the
// distributions of <random> are not, so they are written out here.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace rfmvo::simulate {

// One stream per purpose: what one part of the simulation draws never shifts what another draws.
class Random {
 public:
  Random(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0);

  [[nodiscard]] double uniform();                      // [0, 1), 53 bits
  [[nodiscard]] double uniform(double a, double b);    // [a, b)
  [[nodiscard]] double normal();                       // mean 0, variance 1 (Box and Muller)
  [[nodiscard]] double exponential();                  // mean 1
  [[nodiscard]] std::size_t below(std::size_t count);  // 0 .. count-1; the bias of 2^-53 * count is nothing here

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace rfmvo::simulate
