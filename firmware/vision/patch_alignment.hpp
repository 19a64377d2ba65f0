// Finds a small patch of one image in another, warped as the two poses say, with gain and offset free.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "vision/optical_flow.hpp"

namespace rfmvo {

struct PatchSearch {
  cv::Point2f from_px;                                      // the patch's centre in `from`, full resolution
  cv::Point2f predicted_px;                                 // where it should be in `to`
  Eigen::Matrix2d A_from_to = Eigen::Matrix2d::Identity();  // d px in `from` / d px in `to`
};

// Inverse-compositional alignment (Baker and Matthews 2004), coarse to fine. No value: it left the
// image, moved too far from the prediction, or does not look the same (correlation).
[[nodiscard]] std::optional<cv::Point2f> align_patch(const Pyramid& from, const Pyramid& to, const PatchSearch& search,
                                                     int coarsest_level);

}  // namespace rfmvo
