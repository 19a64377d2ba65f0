// What the paper's method needs: the wall with one trouble after the other taken away.
#pragma once

#include "montecarlo/recording.hpp"
#include "reproduce/results.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::reproduce {

// Names only; number n belongs to simulation_of(n).
[[nodiscard]] std::vector<Condition> empty_conditions();
[[nodiscard]] simulate::Options simulation_of(std::size_t n, const simulate::Options& wall);

// Adds one run to a condition; call finish() after the last.
class ConditionRuns {
 public:
  void add(const montecarlo::Recording& recording, const Config& paper);
  void finish(Condition& condition) const;

 private:
  struct Side {
    std::vector<double> tags_m, scales;
  };
  static void add(const PaperRun& run, Side& side);
  static void finish(const Side& side, Condition::Side& result);

  std::size_t tags_ = 0;
  Side paper_, repaired_;
};

}  // namespace rfmvo::reproduce
