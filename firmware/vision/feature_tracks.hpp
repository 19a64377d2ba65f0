// The list of landmarks being followed: carried from image to image, and filled up with new corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/camera_model.hpp"
#include "vision/map.hpp"

namespace rfmvo {

// The tracks that could be followed from one image to the next; predicted_px holds one start per track.
[[nodiscard]] std::vector<Track> advanced(std::span<const Track> tracks, const Pyramid& from, const Pyramid& to,
                                          std::span<const cv::Point2f> predicted_px, const CameraModel& camera);

// Appends new corners, up to max_tracks in all; next_landmark counts up.
void refill(std::vector<Track>& tracks, const cv::Mat& grey, const CameraModel& camera, int max_tracks,
            std::int64_t& next_landmark);

}  // namespace rfmvo
