#include "vision/corners.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>

namespace rfmvo {
namespace {

constexpr int kFastThreshold = 20;      // Rosten's usual value; noise of a cheap sensor is 2..4 grey levels
constexpr int kFastThresholdFaint = 7;  // as ORB-SLAM's second try, for cells without a strong corner
constexpr int kBorder_px = 10;          // the KLT window must lie inside the image
constexpr double kWellFilled = 0.6;     // of the cells: no second try for the faint ones

struct Grid {
  int size_px, columns, rows;
  [[nodiscard]] std::size_t cell(const cv::Point2f& p) const {
    const int column = std::clamp(static_cast<int>(p.x) / size_px, 0, columns - 1);
    const int row = std::clamp(static_cast<int>(p.y) / size_px, 0, rows - 1);
    return static_cast<std::size_t>(row * columns + column);
  }
};

// Fills cells whose best response is zero; returns how many cells are taken then.
int fill(const cv::Mat& grey, int threshold, const Grid& grid, const std::vector<char>& taken,
         std::vector<cv::KeyPoint>& best) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(grey, found, threshold, true);
  const cv::Rect inside(kBorder_px, kBorder_px, grey.cols - 2 * kBorder_px, grey.rows - 2 * kBorder_px);
  for (const cv::KeyPoint& k : found) {
    if (!inside.contains(cv::Point(k.pt))) continue;
    const std::size_t cell = grid.cell(k.pt);
    if (!taken[cell] && k.response > best[cell].response) best[cell] = k;
  }
  return static_cast<int>(std::count(taken.begin(), taken.end(), 1) +
                          std::count_if(best.begin(), best.end(), [](const auto& k) { return k.response > 0; }));
}

}  // namespace

std::vector<cv::Point2f> find_corners(const cv::Mat& grey, std::span<const cv::Point2f> occupied, int max_total,
                                      int count) {
  if (count <= 0) return {};
  const int size = std::max(8, static_cast<int>(std::sqrt(static_cast<double>(grey.total()) / max_total)));
  const Grid grid{size, (grey.cols + size - 1) / size, (grey.rows + size - 1) / size};
  const auto cells = static_cast<std::size_t>(grid.columns * grid.rows);
  std::vector<char> taken(cells, 0);
  for (const cv::Point2f& p : occupied) taken[grid.cell(p)] = 1;
  std::vector<cv::KeyPoint> best(cells, cv::KeyPoint(0, 0, 0, -1, 0));
  const int filled = fill(grey, kFastThreshold, grid, taken, best);
  if (filled < kWellFilled * static_cast<double>(cells)) fill(grey, kFastThresholdFaint, grid, taken, best);
  std::erase_if(best, [](const cv::KeyPoint& k) { return k.response <= 0; });
  std::stable_sort(best.begin(), best.end(), [](const auto& a, const auto& b) { return a.response > b.response; });
  if (best.size() > static_cast<std::size_t>(count)) best.resize(static_cast<std::size_t>(count));
  std::vector<cv::Point2f> corners;
  for (const cv::KeyPoint& k : best) corners.push_back(k.pt);
  return corners;
}

}  // namespace rfmvo
