#include "vision/patch_alignment.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

namespace rfmvo {
namespace {

constexpr int kHalf = 5;  // 11 x 11, as the tracker's window
constexpr int kSide = 2 * kHalf + 1;
constexpr int kBordered = kSide + 2;  // one more on each side, for gradients

constexpr int kIterations = 10;
constexpr float kStepDone_px = 0.01F;
constexpr double kMaxShift_px = 10.0;  // from the prediction; measured: 5 finds too little, 15 no more
constexpr float kMinCorrelation = 0.85F;
constexpr double kMaxZoom = 1.8;                   // beyond, in or out, a patch no longer looks the same
constexpr float kMinGain = 0.3F, kMaxGain = 3.0F;  // exposure changes within these
using Patch = std::array<float, kSide * kSide>;

bool sample(const cv::Mat& image, double x, double y, float& value) {
  if (!(x >= 0.0 && y >= 0.0)) return false;
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  if (ix + 1 >= image.cols || iy + 1 >= image.rows) return false;
  const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const std::uint8_t* row = image.ptr<std::uint8_t>(iy) + ix;
  const std::uint8_t* next = image.ptr<std::uint8_t>(iy + 1) + ix;
  value = (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * next[0] + fx * next[1]);
  return true;
}

struct Template {
  Patch value;
  std::array<Eigen::Vector4f, kSide * kSide> gradient;  // d value / d x, y, gain, offset
  Eigen::Matrix4f H_inverse;
};

bool cut(const cv::Mat& image, const cv::Point2d& centre, const Eigen::Matrix2d& A, Template& t) {
  std::array<float, kBordered * kBordered> wide{};
  for (int y = 0; y < kBordered; ++y) {
    for (int x = 0; x < kBordered; ++x) {
      const Eigen::Vector2d d = A * Eigen::Vector2d(x - kHalf - 1, y - kHalf - 1);
      if (!sample(image, centre.x + d.x(), centre.y + d.y(), wide[static_cast<std::size_t>(y * kBordered + x)]))
        return false;
    }
  }
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto i = static_cast<std::size_t>(y * kSide + x);
      const auto w = static_cast<std::size_t>((y + 1) * kBordered + x + 1);
      t.value[i] = wide[w];
      t.gradient[i] = {0.5F * (wide[w + 1] - wide[w - 1]), 0.5F * (wide[w + kBordered] - wide[w - kBordered]), wide[w],
                       1.0F};
      const Eigen::Vector4d g = t.gradient[i].cast<double>();
      H.noalias() += g * g.transpose();
    }
  }
  H.diagonal().array() += 1e-6;
  t.H_inverse = H.inverse().cast<float>();
  return true;
}

// The patch of `image` centred at `at`, not warped: all its samples share one pair of bilinear weights.
bool look(const cv::Mat& image, const cv::Point2d& at, Patch& patch) {
  const double x = at.x - kHalf, y = at.y - kHalf;
  if (!(x >= 0.0 && y >= 0.0)) return false;
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  if (ix + kSide >= image.cols || iy + kSide >= image.rows) return false;
  const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const float w00 = (1 - fx) * (1 - fy), w01 = fx * (1 - fy), w10 = (1 - fx) * fy, w11 = fx * fy;
  for (int r = 0; r < kSide; ++r) {
    const std::uint8_t* row = image.ptr<std::uint8_t>(iy + r) + ix;
    const std::uint8_t* next = image.ptr<std::uint8_t>(iy + r + 1) + ix;
    float* out = patch.data() + r * kSide;
    for (int c = 0; c < kSide; ++c) out[c] = w00 * row[c] + w01 * row[c + 1] + w10 * next[c] + w11 * next[c + 1];
  }
  return true;
}

bool align(const cv::Mat& image, const Template& t, cv::Point2d& at) {
  float gain = 1.0F, offset = 0.0F;
  Patch seen;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (!look(image, at, seen)) return false;
    Eigen::Vector4f b = Eigen::Vector4f::Zero();
    for (std::size_t i = 0; i < seen.size(); ++i) b += t.gradient[i] * (seen[i] - gain * t.value[i] - offset);
    const Eigen::Vector4f step = t.H_inverse * b;
    if (!step.allFinite()) return false;
    at.x -= static_cast<double>(step.x() / gain);
    at.y -= static_cast<double>(step.y() / gain);
    gain += step.z();
    offset += step.w();
    if (!(gain > kMinGain && gain < kMaxGain)) return false;
    if (step.head<2>().norm() < kStepDone_px) return true;
  }
  return true;
}

float correlation(const cv::Mat& image, const Template& t, const cv::Point2d& at) {
  Patch seen;
  if (!look(image, at, seen)) return 0.0F;
  using Values = Eigen::Map<const Eigen::Array<float, kSide * kSide, 1>>;
  const Eigen::Array<float, kSide * kSide, 1> a = Values(t.value.data()) - Values(t.value.data()).mean();
  const Eigen::Array<float, kSide * kSide, 1> b = Values(seen.data()) - Values(seen.data()).mean();
  const float power = (a * a).sum() * (b * b).sum();
  return power > 0.0F ? (a * b).sum() / std::sqrt(power) : 0.0F;
}

}  // namespace

std::optional<cv::Point2f> align_patch(const Pyramid& from, const Pyramid& to, const PatchSearch& search,
                                       int coarsest_level) {
  const double zoom = std::sqrt(std::abs(search.A_from_to.determinant()));
  if (!(zoom < kMaxZoom && zoom > 1.0 / kMaxZoom)) return std::nullopt;
  cv::Point2d at(search.predicted_px);
  float look_alike = 0.0F;
  for (int level = coarsest_level; level >= 0; --level) {
    const double k = 1.0 / (1 << level);
    const std::size_t image = 2 * static_cast<std::size_t>(level);  // every other one is a gradient
    Template t;
    if (!cut(from[image], cv::Point2d(search.from_px) * k, search.A_from_to, t)) return std::nullopt;
    cv::Point2d scaled = at * k;
    if (!align(to[image], t, scaled)) return std::nullopt;
    at = scaled * (1.0 / k);
    if (cv::norm(at - cv::Point2d(search.predicted_px)) > kMaxShift_px) return std::nullopt;
    if (level == 0) look_alike = correlation(to[image], t, scaled);
  }
  if (look_alike < kMinCorrelation) return std::nullopt;
  return cv::Point2f(at);
}

}  // namespace rfmvo
