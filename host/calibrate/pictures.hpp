// Pictures for a calibration: image files, folders of them, or the frames of a journal.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"

namespace cv {
class Mat;
}

namespace rfmvo::calibrate {

struct PictureSources {
  std::vector<std::string> inputs;
  Duration every{Duration::from_seconds(0.5)};  // of journals: neighbouring frames say the same
  std::string prefix;                           // of a journal's channels
};

// Hands each picture (grey, 8 bits) and its name to `sink`. Errors: kNotFound, kUnreadable naming the input, or as of
// sink.
[[nodiscard]] Status for_each_picture(const PictureSources& sources,
                                      const std::function<Status(const cv::Mat& grey, const std::string& name)>& sink);

}  // namespace rfmvo::calibrate
