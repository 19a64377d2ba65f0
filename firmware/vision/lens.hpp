// What the odometry learns about its camera while it runs: the lens's first radial coefficient and the
// time that the sensor takes to read one picture out (0: global shutter).
#pragma once

#include <Eigen/Core>

#include "geometry/camera_model.hpp"
#include "vision/view_pose.hpp"

namespace rfmvo {

using LensVector = Eigen::Vector2d;  // k1, readout (s)
using LensMatrix = Eigen::Matrix2d;
using LensJacobian = Eigen::Matrix2d;  // rows: normalised x and y

struct LensPrior {
  double k1_sigma = 0.0;         // 0: k1 stays as calibrated
  double readout_s = 0.0;        // what is known of the readout time
  double readout_sigma_s = 0.0;  // 0: the readout time stays as told
};

// How a camera moves, in its own frame: d p_C / dt = omega x p_C + v of a point that stands still.
struct Twist {
  Eigen::Vector3d omega_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_s = Eigen::Vector3d::Zero();  // units of V per s
};
[[nodiscard]] Twist twist_between(const ViewPose& earlier, const ViewPose& later, double seconds);

// d (normalised point) / dt of a point at p_C, which is in front of the camera.
[[nodiscard]] Eigen::Vector2d image_flow_s(const Eigen::Vector3d& p_C, const Twist& twist);

// d unproject() / d k1 at the point that unproject() gave.
[[nodiscard]] Eigen::Vector2d d_unproject_d_k1(const CameraModel& camera, const Eigen::Vector2d& normalised);

// When a row is read: -0.5 (first) .. 0.5 (last), in readout times from the picture's stamp.
[[nodiscard]] inline double row_share(const CameraModel& camera, double y_px) {
  return (y_px + 0.5) / camera.height_px - 0.5;
}

// The present estimate, with what earlier windows of key frames told.
class Lens {
 public:
  Lens(const CameraModel& calibrated, const LensPrior& prior);

  [[nodiscard]] const CameraModel& camera() const { return camera_; }
  [[nodiscard]] double readout_s() const { return value_(1); }
  [[nodiscard]] bool is_free() const { return free_; }
  // The next window should estimate it: always once it has moved; before, some are enough to notice that it should.
  [[nodiscard]] bool is_asked() const { return free_ && (shown_[0] || shown_[1] || windows_ % kAskEvery == 0); }
  // Known as well as it needs to be: until the images have confirmed or contradicted the calibration, it is not.
  [[nodiscard]] bool is_certain() const { return !free_ || (seen_[0] && seen_[1] && !shown_[0] && !shown_[1]); }
  // What is left open: of a confirmed calibration nothing.
  [[nodiscard]] LensMatrix covariance() const;
  void skip() { ++windows_; }  // a window that was not asked
  // The last window moved the lens so far that a map made before does not fit it any more.
  [[nodiscard]] bool is_settling() const { return settling_; }

  // Where the sight line would have met the image if all rows had been read at the stamp.
  [[nodiscard]] Eigen::Vector2d at_stamp(const Eigen::Vector2d& normalised, double y_px, const Eigen::Vector3d& p_C,
                                         const Twist& twist) const;
  [[nodiscard]] LensJacobian d_at_stamp(const Eigen::Vector2d& normalised, double y_px, const Eigen::Vector3d& p_C,
                                        const Twist& twist) const;

  // What is known besides the window at hand, as a quadratic cost in px^2 around expected_step(). The calibration
  // is held until a window contradicts it: passing a shelf, a little distortion looks like a little turn, and a lens
  // that follows every hint bends the path (measured: 0.003..0.015 of k1 invented, 0.25 % of error instead of 0.03).
  [[nodiscard]] LensMatrix information() const;
  [[nodiscard]] LensVector expected_step() const;

  // The window's answer: a step; and of its images alone, where that led, the information (px^2) and the pull:
  // information times the further step they want.
  void learn(const LensVector& step, const LensMatrix& window_information, const LensVector& window_pull);

 private:
  static constexpr int kAskEvery = 3;
  void judge(int i, const LensMatrix& information, const LensVector& pull);

  CameraModel camera_;
  LensVector prior_, value_, carried_;
  LensMatrix prior_information_ = LensMatrix::Zero(), carried_information_ = LensMatrix::Zero();
  bool shown_[2] = {false, false};  // contradicted
  bool seen_[2] = {false, false};   // clearly, by a window
  bool settling_ = false;
  int windows_ = 0;
  bool free_ = false;
};

}  // namespace rfmvo
