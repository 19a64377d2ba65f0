#include "calibrate/board.hpp"

#include <map>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace rfmvo::calibrate {
namespace {

constexpr std::size_t kMinCorners = 6;  // of a part of a ChArUco board

const std::map<std::string, int>& dictionaries() {
  static const std::map<std::string, int> kAll = {{"4X4_50", cv::aruco::DICT_4X4_50},
                                                  {"4X4_100", cv::aruco::DICT_4X4_100},
                                                  {"4X4_250", cv::aruco::DICT_4X4_250},
                                                  {"4X4_1000", cv::aruco::DICT_4X4_1000},
                                                  {"5X5_50", cv::aruco::DICT_5X5_50},
                                                  {"5X5_100", cv::aruco::DICT_5X5_100},
                                                  {"5X5_250", cv::aruco::DICT_5X5_250},
                                                  {"5X5_1000", cv::aruco::DICT_5X5_1000},
                                                  {"6X6_50", cv::aruco::DICT_6X6_50},
                                                  {"6X6_100", cv::aruco::DICT_6X6_100},
                                                  {"6X6_250", cv::aruco::DICT_6X6_250},
                                                  {"6X6_1000", cv::aruco::DICT_6X6_1000},
                                                  {"7X7_50", cv::aruco::DICT_7X7_50},
                                                  {"ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
                                                  {"APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11}};
  return kAll;
}

cv::Ptr<cv::aruco::CharucoBoard> charuco(const Board& board) {
  const double marker_m = board.marker_m > 0.0 ? board.marker_m : 0.75 * board.square_m;
  return cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m),
                                         static_cast<float>(marker_m),
                                         cv::aruco::getPredefinedDictionary(dictionaries().at(board.dictionary)));
}

std::optional<View> find_checkerboard(const Board& board, const cv::Mat& grey, const std::string& name) {
  std::vector<cv::Point2f> corners;
  const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;
  if (!cv::findChessboardCornersSB(grey, {board.columns, board.rows}, corners, flags)) return std::nullopt;
  View view{name, {}, {}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto columns = static_cast<std::size_t>(board.columns);
    view.board_m.push_back(
        {static_cast<double>(i % columns) * board.square_m, static_cast<double>(i / columns) * board.square_m});
    view.image_px.push_back({corners[i].x, corners[i].y});
  }
  return view;
}

std::optional<View> find_charuco(const Board& board, const cv::Mat& grey, const std::string& name) {
  const auto layout = charuco(board);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids, ids;
  std::vector<cv::Point2f> corners;
  cv::aruco::detectMarkers(grey, layout->dictionary, markers, marker_ids);
  if (marker_ids.empty()) return std::nullopt;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, grey, layout, corners, ids);
  if (corners.size() < kMinCorners) return std::nullopt;
  View view{name, {}, {}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point3f on_board = layout->chessboardCorners[static_cast<std::size_t>(ids[i])];
    view.board_m.push_back({on_board.x, on_board.y});
    view.image_px.push_back({corners[i].x, corners[i].y});
  }
  return view;
}

cv::Mat draw_checkerboard(const Board& board, int square_px) {
  cv::Mat picture((board.rows + 3) * square_px, (board.columns + 3) * square_px, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row <= board.rows; ++row)
    for (int column = row % 2; column <= board.columns; column += 2)
      picture(cv::Rect((column + 1) * square_px, (row + 1) * square_px, square_px, square_px)) = 0;
  return picture;
}

}  // namespace

Status check(const Board& board) {
  if (board.columns < 3 || board.rows < 3 || board.columns > 100 || board.rows > 100)
    return Error{ErrorCode::kOutOfRange, "3 to 100 columns and rows are expected", "board"};
  if (!(board.square_m > 0.0)) return Error{ErrorCode::kOutOfRange, "a square has a positive side", "board"};
  if (board.kind == BoardKind::kCheckerboard) return Done{};
  if (board.marker_m >= board.square_m)
    return Error{ErrorCode::kOutOfRange, "a marker is smaller than its square", "board"};
  const auto dictionary = dictionaries().find(board.dictionary);
  if (dictionary == dictionaries().end()) {
    std::string known;
    for (const auto& [name, id] : dictionaries()) known += (known.empty() ? "" : ", ") + name;
    return Error{ErrorCode::kUnsupported, "unknown dictionary; known: " + known, board.dictionary};
  }
  if (board.columns * board.rows / 2 > cv::aruco::getPredefinedDictionary(dictionary->second)->bytesList.rows)
    return Error{ErrorCode::kOutOfRange, "the board has more squares than the dictionary has markers",
                 board.dictionary};
  return Done{};
}

std::optional<View> find_board(const Board& board, const cv::Mat& grey, const std::string& name) {
  return board.kind == BoardKind::kCharuco ? find_charuco(board, grey, name) : find_checkerboard(board, grey, name);
}

Result<cv::Mat> draw_board(const Board& board, int square_px) {
  if (const Status s = check(board); !s) return s.error();
  if (board.kind == BoardKind::kCheckerboard) return draw_checkerboard(board, square_px);
  cv::Mat picture;
  charuco(board)->draw({(board.columns + 2) * square_px, (board.rows + 2) * square_px}, picture, square_px);
  return picture;
}

}  // namespace rfmvo::calibrate
