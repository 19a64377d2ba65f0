// Stage 3, joint optimization (paper section IV): refined angles, line intersection and
// Levenberg-Marquardt on the distance differences in turns, Eq. (16)-(22), for ONE antenna array of
// one tag (all its M antennas).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "estimator/antenna_array.hpp"
#include "estimator/incident_angles.hpp"
#include "estimator/line_intersection.hpp"

namespace rfmvo {

inline constexpr double kMaxTagRange_m = 20.0;  // no passive UHF tag answers from farther

struct JointOptions {
  double refine_step_rad = 0.0;   // delta alpha_opt = delta beta_opt of Eq. (16)
  double refine_range_rad = 0.0;  // mu of Eq. (16)
  int max_iterations = 10;        // of the outer loop, l
  bool fix_sphere_average = false;
  bool fix_cycles = false;
};

// What one antenna contributes: its array, the start of its angles, and for each element the angles
// of all OTHER arrays that contain the element (they are held; Eq. (9), (10)).
struct AntennaTerm {
  AntennaArray array;
  IncidentAngles angles;
  std::vector<AngleSums> others;  // one per element
};

struct ArraySolution {
  bool found = false;      // false: parallel lines, no convergence, or a position out of any reader's range
  bool converged = false;  // within max_iterations: the paper repeats "until it converges"
  int iterations = 0;
  Eigen::Vector3d p_X_m = Eigen::Vector3d::Zero();       // X_T: axes of V, origin the camera at the first read, metres
  double gamma = 0.0;                                    // metres per unit of V
  double sigma_m = 0.0;                                  // rms residual of Eq. (18)
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // of (X_T, gamma): sigma^2 (J'J)^-1, bounded
  std::vector<IncidentAngles> angles;                    // refined, one per antenna
};

// Section III.B, Eq. (17): the point nearest to the M x L lines along the averaged directions. angles: one per
// antenna, of this array; the others' are in the terms.
[[nodiscard]] LineIntersection intersect_lines(std::span<const AntennaTerm> antennas,
                                               std::span<const IncidentAngles> angles, double gamma,
                                               bool fix_sphere_average);

[[nodiscard]] ArraySolution joint_optimization(std::span<const AntennaTerm> antennas, double gamma,
                                               const JointOptions& options);

// Eq. (21), (22): the multiple of 2 pi of one phase difference, from the length of the antenna's step.
// Eq. (22) is wrong for about half of the steps it is for (docs/paper.md).
[[nodiscard]] double cycle_step_by_length_rad(double phase_step_rad, double antenna_step_m, double wavelength_m);

// Residuals of Eq. (18), Delta d_A - Delta d_C in metres, over all usable steps of all antennas, and their
// derivatives with respect to (X_T, gamma).
struct DistanceResiduals {
  Eigen::VectorXd r_m;
  Eigen::Matrix<double, Eigen::Dynamic, 4> jacobian;
};
// distance_step_m: Delta d_A of Eq. (19), in the order of the residuals.
[[nodiscard]] DistanceResiduals distance_residuals(std::span<const AntennaTerm> antennas,
                                                   const Eigen::VectorXd& distance_step_m, const Eigen::Vector3d& p_X_m,
                                                   double gamma);

}  // namespace rfmvo
