// The ports' offsets before any position is sure: for each tag a list of places where its reads agree port
// by port; the offsets that make the ports agree with one another, at one place of every tag.
// docs/estimator.md, section 5.
#pragma once

#include <complex>
#include <vector>

#include "estimator/joint_problem.hpp"

namespace rfmvo {

struct TagPlaces {
  std::vector<Eigen::Vector3d> p_W_X;
  std::vector<std::vector<std::complex<double>>> phasor;  // per place and port: sum of exp j (measured - predicted)
  double reads = 0.0;                                     // of all ports
};

// Phasors of one tag's reads at the places, port offsets and the tag's own taken as zero.
[[nodiscard]] TagPlaces phasors_at(const std::vector<JointRead>& reads, const JointState& state,
                                   std::vector<Eigen::Vector3d> places);

struct PortOffsets {
  std::vector<double> offset_rad;  // per port, the first 0
  double power = 0.0;              // sum over tags of the best place's |sum over ports|^2 / reads
};

// Local maxima of the power over the offsets, strongest first, at most `count`. One port: one answer.
[[nodiscard]] std::vector<PortOffsets> scan_port_offsets(const std::vector<TagPlaces>& tags, std::size_t ports,
                                                         std::size_t count);

// The place of a tag that the offsets favour.
[[nodiscard]] std::size_t best_place(const TagPlaces& tag, const std::vector<double>& offset_rad);

}  // namespace rfmvo
