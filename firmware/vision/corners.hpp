// New corners to follow: the best one of every cell of a grid.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace rfmvo {

// FAST corners of an 8-bit grey image, at most one per empty cell and at most `count` in all, the
// strongest first. Cells are sized for `max_total` corners over the image; a cell that holds one of
// `occupied` is left alone.
[[nodiscard]] std::vector<cv::Point2f> find_corners(const cv::Mat& grey, std::span<const cv::Point2f> occupied,
                                                    int max_total, int count);

}  // namespace rfmvo
