#include "estimator/phase_error_model.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rfmvo {

double matern32(double distance_m, double length_m) {
  const double a = std::abs(distance_m) / length_m;
  return (1.0 + a) * std::exp(-a);
}

double structured_correlation(double distance_m, const StructuredShape& shape) {
  const double near = matern32(distance_m, shape.length_m);
  if (shape.long_share == 0.0) return near;
  return near + shape.long_share * (matern32(distance_m, kLongLength_m) - near);
}

double relative_strength(double fade_db, const StructuredShape& shape) {
  constexpr double kFieldTwice_db = 40.0;  // of power there and back, per factor of ten in the field
  return shape.fade_exponent == 0.0 ? 1.0 : std::pow(10.0, shape.fade_exponent * fade_db / kFieldTwice_db);
}

double white_sigma_rad(double rssi_dbm) {
  constexpr double kStrong_dbm = -45.0, kMiddle_dbm = -50.0, kWeak_dbm = -57.0;
  constexpr double kStrong_rad = 0.022, kMiddle_rad = 0.06, kWeak_rad = 0.2;
  if (rssi_dbm >= kStrong_dbm) return kStrong_rad;
  if (rssi_dbm <= kWeak_dbm) return kWeak_rad;
  if (rssi_dbm >= kMiddle_dbm)
    return kMiddle_rad + (kStrong_rad - kMiddle_rad) * (rssi_dbm - kMiddle_dbm) / (kStrong_dbm - kMiddle_dbm);
  return kWeak_rad + (kMiddle_rad - kWeak_rad) * (rssi_dbm - kWeak_dbm) / (kMiddle_dbm - kWeak_dbm);
}

Conditioning condition_on_correlated(std::size_t count, const Eigen::Matrix<double, 4, 4>& correlation,
                                     const Eigen::Vector4d& white_rad2, double structured_sigma_rad) {
  const double power = structured_sigma_rad * structured_sigma_rad;
  Conditioning c;
  c.variance_rad2 = power * correlation(0, 0) + white_rad2[0];
  if (count == 0) return c;
  const auto n = static_cast<Eigen::Index>(count);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> K = power * correlation.block(1, 1, n, n);
  K.diagonal() += white_rad2.segment(1, n);
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> k = power * correlation.col(0).segment(1, n);
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> a = K.llt().solve(k);
  for (Eigen::Index i = 0; i < n; ++i) c.weights[static_cast<std::size_t>(i)] = a[i];
  c.variance_rad2 = std::max(c.variance_rad2 - k.dot(a), white_rad2[0]);
  return c;
}

Conditioning condition_on_neighbours(std::size_t count, const Eigen::Matrix<double, 4, 4>& distances_m,
                                     const Eigen::Vector4d& white_rad2, double structured_sigma_rad, double length_m) {
  const Eigen::Matrix4d correlation = distances_m.unaryExpr([&](double d) { return matern32(d, length_m); });
  return condition_on_correlated(count, correlation, white_rad2, structured_sigma_rad);
}

}  // namespace rfmvo
