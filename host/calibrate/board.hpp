// Calibration boards and their corners in a picture.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace cv {
class Mat;
}

namespace rfmvo::calibrate {

enum class BoardKind { kCheckerboard, kCharuco };

struct Board {
  BoardKind kind = BoardKind::kCheckerboard;
  int columns = 9, rows = 6;  // checkerboard: INNER corners; ChArUco: squares
  double square_m = 0.03;
  double marker_m = 0.0;              // ChArUco: side of a marker; 0: three quarters of a square
  std::string dictionary = "4X4_50";  // ChArUco: OpenCV's predefined ones
};

struct Point2 {
  double x = 0.0, y = 0.0;
};

// One picture's corners: where they are on the board (m, in its plane) and in the picture (px).
struct View {
  std::string name;
  std::vector<Point2> board_m, image_px;
};

// Errors: kOutOfRange for a board that cannot be; kUnsupported naming an unknown dictionary.
[[nodiscard]] Status check(const Board& board);
// Nothing: no board is seen, or too little of it. `grey`: 8 bits.
[[nodiscard]] std::optional<View> find_board(const Board& board, const cv::Mat& grey, const std::string& name);
// The board as a picture to print, `square_px` a square. Errors: as check().
[[nodiscard]] Result<cv::Mat> draw_board(const Board& board, int square_px);

}  // namespace rfmvo::calibrate
