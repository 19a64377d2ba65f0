// Pictures of the odometry at work: the image with the points it follows, beside it the map from above.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "base/result.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo::odometry {

class ViewWriter {
 public:
  // FILE.mp4: a film, one picture per frame. FILE.png: the last frame. Errors: kUnsupported for other
  // names, kUnwritable naming the file.
  [[nodiscard]] static Result<std::unique_ptr<ViewWriter>> create(const std::string& path);
  ~ViewWriter();
  ViewWriter(const ViewWriter&) = delete;
  ViewWriter& operator=(const ViewWriter&) = delete;

  // Green: a point of the map; orange: not located yet; red: does not fit. Lines: the way of the last frames.
  [[nodiscard]] Status add(const Frame& frame, const CameraPose& pose, const VisualOdometry& odometry);
  [[nodiscard]] Status close();  // the file appears now, under its name

 private:
  struct Impl;
  explicit ViewWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo::odometry
