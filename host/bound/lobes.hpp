// What the Cramer-Rao bound leaves out: a tag's phases repeat, nearly, at other places (lobes), and noise makes one of
// these the likeliest now and then. Method of interval errors (Van Trees and Bell, Bayesian Bounds, 2007; Athley, IEEE
// Trans. Signal Processing 53(4), 2005): mean square error = (1 - P) local bound^2 + sum of P_k |p_k - p|^2, with P_k
// the probability that lobe k wins. Here P_k is counted over drawn errors, for an observer that knows the true path,
// lever arms, port offsets, electrical lengths and the law of the errors, and asks for one tag's position and offset:
// an estimator that knows less, from phases alone, cannot pick the true lobe more often. Other evidence (signal
// strength, antenna pattern) is not in it, nor are lobes beyond the region searched.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bound/bound.hpp"

namespace rfmvo::bound {

struct LobeSettings {
  double region_m = 1.2;  // half side of the cube about the true place that is searched
  double cell_m = 0.05;   // of the search; a lobe is 8 cm wide or more (a quarter of the wavelength)
  std::size_t draws = 200;
  std::uint64_t seed = 1;
};

struct TagLobes {
  std::size_t lobes = 0;           // other places that compete
  double wrong_probability = 0.0;  // that one of them is the likeliest
  double square_m2 = 0.0;          // mean of |p_k - p|^2, 0 where the true lobe wins
};

struct Lobes {
  std::vector<TagLobes> tags;    // in the world's order
  double wrong_share = 0.0;      // mean of wrong_probability over the tags that have a bound
  std::optional<double> rmse_m;  // over the same tags, local bound and lobes together
};

// `bound`: of the same world.
[[nodiscard]] Lobes lobes_of(const World& world, const Bound& bound, const LobeSettings& settings = {});

// The root mean square of one tag's error; nothing where the local bound is none.
[[nodiscard]] std::optional<double> rmse_with_lobes_m(const TagBound& bound, const TagLobes& lobes);

}  // namespace rfmvo::bound
