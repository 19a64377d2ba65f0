#include "estimator/antenna_array.hpp"

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo {

AntennaArray make_array(const std::deque<SampledRead>& reads, std::size_t first, std::size_t count,
                        const Eigen::Vector3d& p_V_origin, const AntennaCalibration& antenna,
                        const PhaseCalibration& phases, const ArrayOptions& options) {
  RFMVO_ASSERT(count >= 2 && first + count <= reads.size());
  const auto n = static_cast<Eigen::Index>(count);
  AntennaArray array{Eigen::Matrix3Xd(3, n), Eigen::Matrix3Xd(3, n), Eigen::VectorXd::Zero(n - 1),
                     Eigen::VectorXd(n - 1), Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(n - 1, false)};
  double frequency_sum_hz = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const SampledRead& sample = reads[first + static_cast<std::size_t>(i)];
    array.camera_V.col(i) = sample.T_V_C.p_V_C - p_V_origin;
    // Eq. (12): in the axes of V, which are the camera's at the start.
    array.lever_V_m.col(i) =
        options.fix_rotation ? Eigen::Vector3d(sample.T_V_C.R_V_C * antenna.p_C_A_m) : antenna.p_C_A_m;
    frequency_sum_hz += static_cast<double>(sample.read.frequency_hz);
    if (i == 0) continue;
    const SampledRead& before = reads[first + static_cast<std::size_t>(i) - 1];
    array.duration_s(i - 1) = (sample.read.time - before.read.time).seconds();
    const auto step = phases.phase_step_rad(before.read, sample.read);
    if (!step) continue;
    array.phase_step_rad(i - 1) = *step;
    array.usable(i - 1) = true;
  }
  array.wavelength_m = kSpeedOfLight_m_s * static_cast<double>(count) / frequency_sum_hz;
  array.R_V_D = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), antenna.boresight_C);
  if (options.turning_frame) array.R_V_D = reads[first + count / 2].T_V_C.R_V_C * array.R_V_D;
  return array;
}

}  // namespace rfmvo
