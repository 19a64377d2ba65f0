// The phase of one read as a function of everything unknown: a spherical wave and sums of offsets. For
// real numbers and for complex ones, so that derivatives come from a complex step, exact to rounding.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>

#include "base/units.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo::bound {

// Truth at the moment of the read, frame S unless said.
struct ReadPlace {
  Eigen::Vector3d p_S_C_m, travelled_m;  // camera; from where it was at the first frame
  Eigen::Matrix3d R_S_C;
  Eigen::Vector3d velocity_m_s, angular_velocity_rad_s;
  Eigen::Vector3d lever_arm_C_m;
  Eigen::Vector3d p_S_X_m;
  double wavenumber_rad_m = 0.0;      // 4 pi f / c
  double frequency_term_rad_m = 0.0;  // 4 pi (f - f0) / c
};

// Changes from the truth, in this order.
enum Unknown : int {
  kTagX = 0,        // 3, S
  kOffset = 3,      // of the tag and the port together
  kLength = 4,      // electrical length of the port
  kLeverArm = 5,    // 3, C
  kLogScale = 8,    // of the whole odometry
  kTimeOffset = 9,  // reads are late by this much
  kShift = 10,      // 3: drift of the camera's position, S
  kTurn = 13,       // 3: drift of its orientation, a small rotation in S
  kUnknowns = 16,
};
using Row = Eigen::Matrix<double, 1, kUnknowns>;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

template <class T>
T phase_rad(const ReadPlace& place, const Eigen::Matrix<T, kUnknowns, 1>& u) {
  // Bilinear cross product: Eigen's conjugates complex numbers.
  const auto cross = [](const Vector3<T>& a, const Vector3<T>& b) {
    return Vector3<T>(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  };
  const T tau = -u[kTimeOffset];  // the camera was there earlier than the stamp says
  const Vector3<T> lever_C = place.lever_arm_C_m.cast<T>() + u.template segment<3>(kLeverArm);
  const Vector3<T> lever = place.R_S_C.cast<T>() * lever_C;
  const Vector3<T> turn = u.template segment<3>(kTurn) + tau * place.angular_velocity_rad_s.cast<T>();
  using std::exp;
  const Vector3<T> antenna = place.p_S_C_m.cast<T>() + (exp(u[kLogScale]) - T(1.0)) * place.travelled_m.cast<T>() +
                             tau * place.velocity_m_s.cast<T>() + u.template segment<3>(kShift) + lever +
                             cross(turn, lever);
  const Vector3<T> ray = antenna - place.p_S_X_m.cast<T>() - u.template segment<3>(kTagX);
  using std::sqrt;
  const T distance = sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
  return place.wavenumber_rad_m * distance + u[kOffset] + place.frequency_term_rad_m * u[kLength];
}

[[nodiscard]] inline Row derivative(const ReadPlace& place) {
  constexpr double kStep = 1e-20;  // no difference is taken, so it may be as small as it likes
  Row row;
  for (int i = 0; i < kUnknowns; ++i) {
    Eigen::Matrix<std::complex<double>, kUnknowns, 1> u = Eigen::Matrix<std::complex<double>, kUnknowns, 1>::Zero();
    u[i] = {0.0, kStep};
    row[i] = phase_rad(place, u).imag() / kStep;
  }
  return row;
}

}  // namespace rfmvo::bound
