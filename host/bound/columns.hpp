// All unknowns of a run in one vector, and how a read, a tag and the path depend on them.
#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "bound/bound.hpp"
#include "bound/path_drift.hpp"
#include "bound/read_model.hpp"

namespace rfmvo::bound {

using SparseRow = std::vector<std::pair<int, double>>;  // column, derivative; each column once

// Order: tag positions (S); offsets; per port its length and lever arm; unless the path is known, the scale,
// the time offset, the drift at knots and the white error of each camera pose that matters.
class Columns {
 public:
  Columns(const World& world, const Settings& settings);

  [[nodiscard]] int size() const { return static_cast<int>(sigmas_.size()); }
  [[nodiscard]] const std::vector<double>& sigmas() const { return sigmas_; }  // of the priors
  [[nodiscard]] SparseRow of_read(const Read& read) const;
  // Rows: position of the tag relative to the camera, in C, at a frame.
  [[nodiscard]] Eigen::MatrixXd of_tag_in_camera(std::size_t tag, std::size_t frame) const;
  // Sim(3) scale between the recovered path and the true one. Without travel: zero.
  [[nodiscard]] Eigen::RowVectorXd of_path_scale() const;
  [[nodiscard]] std::size_t closest_frame(std::size_t tag) const;
  [[nodiscard]] bool has_path() const { return scale_ >= 0; }

 private:
  int add(int count, double sigma);
  void add_path();
  void add_white_pose(std::size_t frame);
  [[nodiscard]] std::size_t frame_before(double t_s) const;
  [[nodiscard]] ReadPlace place_of(const Read& read) const;
  void append_offset(const Read& read, double derivative, SparseRow& row) const;
  void append_path(const Read& read, const Row& derivative, SparseRow& row) const;
  // 6 rows, shift and turn of the camera.
  [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> of_camera(std::size_t frame) const;

  const World& world_;
  const Settings settings_;
  PathDrift drift_;
  std::vector<double> sigmas_;
  int tags_ = 0, offsets_ = 0, ports_ = 0, scale_ = -1, time_offset_ = -1, walks_ = -1;
  std::map<std::size_t, int> white_;  // frame to its first column
};

}  // namespace rfmvo::bound
