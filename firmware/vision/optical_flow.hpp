// Pyramidal Lucas-Kanade tracking with prediction and a forward-backward check.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace rfmvo {

// OpenCV's pyramid: image and gradient of each level in turn.
using Pyramid = std::vector<cv::Mat>;

[[nodiscard]] Pyramid build_pyramid(const cv::Mat& grey);

struct Followed {
  cv::Point2f at_px;
  bool ok = false;
};

// Follows `from_px` (in `from`) to `to`, starting at `predicted_px`; one result per point.
[[nodiscard]] std::vector<Followed> follow(const Pyramid& from, const Pyramid& to, std::span<const cv::Point2f> from_px,
                                           std::span<const cv::Point2f> predicted_px);

}  // namespace rfmvo
