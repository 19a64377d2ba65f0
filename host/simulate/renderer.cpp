#include "simulate/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/assert.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kNear_m = 0.05;
constexpr double kLensBlur_px = 0.7;  // 1 sigma; also softens the rasteriser's stairs
constexpr double kNoise_grey = 1.5;   // 1 sigma, of 8 bits
constexpr int kJpegQuality = 90;
constexpr float kEmpty = 40.0F;  // where nothing stands

// A surface in the camera frame with what each pixel needs: 1/z, u and v are rational in the ray (x, y, 1).
struct Facing {
  const Surface* surface;
  std::vector<Eigen::Vector3d> outline_C;  // clipped at the near plane
  Eigen::Vector3d normal_over_d;           // 1/z = normal_over_d . ray
  Eigen::Vector3d right_C, down_C;
  double right_0 = 0, down_0 = 0;  // u = z * right . ray - right_0
  double plane_distance_m = 0;
  double depth_m = 0;  // of the centre, for the drawing order
};

std::vector<Eigen::Vector3d> clip_near(const std::array<Eigen::Vector3d, 4>& corners) {
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    if (a.z() >= kNear_m) kept.push_back(a);
    if ((a.z() >= kNear_m) != (b.z() >= kNear_m)) kept.push_back(a + (kNear_m - a.z()) / (b.z() - a.z()) * (b - a));
  }
  return kept;
}

bool face(const Surface& s, const Rigid3& T_C_S, Facing& f) {
  f.surface = &s;
  f.right_C = T_C_S.R * s.right;
  f.down_C = T_C_S.R * s.down;
  const Eigen::Vector3d corner = T_C_S * s.corner;
  const Eigen::Vector3d normal = f.right_C.cross(f.down_C);  // away from the viewer
  const double d = normal.dot(corner);
  if (d < 1e-4) return false;  // seen from behind
  f.normal_over_d = normal / d;
  f.plane_distance_m = d;
  f.right_0 = f.right_C.dot(corner);
  f.down_0 = f.down_C.dot(corner);
  const Eigen::Vector3d r = s.width_m * f.right_C, b = s.height_m * f.down_C;
  f.outline_C = clip_near({corner, corner + r, corner + r + b, corner + b});
  f.depth_m = (corner + 0.5 * (r + b)).z();
  return f.outline_C.size() >= 3;
}

struct Target {
  const CameraModel& camera;
  std::vector<float> grey, inverse_depth;
};

void draw_span(const Facing& f, int y, int x_from, int x_to, Target& target) {
  const CameraModel& c = target.camera;
  const Surface& s = *f.surface;
  const double ray_y = (y - c.cy_px) / c.fy_px;
  const double ray_x = (x_from - c.cx_px) / c.fx_px, step = 1.0 / c.fx_px;
  const Eigen::Vector3d ray(ray_x, ray_y, 1.0);
  double w = f.normal_over_d.dot(ray), u = f.right_C.dot(ray), v = f.down_C.dot(ray);
  const double dw = f.normal_over_d.x() * step, du = f.right_C.x() * step, dv = f.down_C.x() * step;
  // Texels per pixel: z / f towards the camera, z^2 / (f d) along the slant; between the two.
  const double footprint = s.texels_per_m.maxCoeff() / c.fx_px;
  std::size_t i = static_cast<std::size_t>(y) * c.width_px + x_from;
  for (int x = x_from; x <= x_to; ++x, ++i, w += dw, u += du, v += dv) {
    if (w <= target.inverse_depth[i]) continue;
    target.inverse_depth[i] = static_cast<float>(w);
    const double z = 1.0 / w;
    const double texels = footprint * z * std::sqrt(std::max(1.0, z / f.plane_distance_m));
    const int level = std::ilogb(std::max(1.0, 1.4 * texels));
    const auto tx = static_cast<float>((z * u - f.right_0) * s.texels_per_m.x());
    const auto ty = static_cast<float>((z * v - f.down_0) * s.texels_per_m.y());
    target.grey[i] = s.brightness * s.texture->sample(tx, ty, level);
  }
}

void draw(const Facing& f, Target& target) {
  const CameraModel& c = target.camera;
  std::vector<Eigen::Vector2d> outline;
  double top = 1e9, bottom = -1e9;
  for (const Eigen::Vector3d& p : f.outline_C) {
    outline.emplace_back(c.fx_px * p.x() / p.z() + c.cx_px, c.fy_px * p.y() / p.z() + c.cy_px);
    top = std::min(top, outline.back().y());
    bottom = std::max(bottom, outline.back().y());
  }
  const int y_from = static_cast<int>(std::ceil(std::clamp(top, 0.0, static_cast<double>(c.height_px))));
  const int y_to = static_cast<int>(std::floor(std::clamp(bottom, -1.0, c.height_px - 1.0)));
  for (int y = y_from; y <= y_to; ++y) {
    double left = 1e9, right = -1e9;
    for (std::size_t i = 0; i < outline.size(); ++i) {  // convex: one span a row
      const Eigen::Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
      if ((a.y() <= y) == (b.y() <= y)) continue;
      const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      left = std::min(left, x);
      right = std::max(right, x);
    }
    const int x_from = static_cast<int>(std::ceil(std::clamp(left, 0.0, static_cast<double>(c.width_px))));
    const int x_to = static_cast<int>(std::floor(std::clamp(right, -1.0, c.width_px - 1.0)));
    if (x_from <= x_to) draw_span(f, y, x_from, x_to, target);
  }
}

cv::Mat as_mat(std::vector<std::uint8_t>& grey, const CameraModel& camera) {
  return {camera.height_px, camera.width_px, CV_8UC1, grey.data()};
}

// Normal numbers are dear, a frame needs 300 000: one table, read from a random place.
const std::vector<float>& noise_table() {
  static const std::vector<float> table = [] {
    Random random(0, "noise table");
    std::vector<float> numbers(1 << 18);
    for (float& n : numbers) n = static_cast<float>(kNoise_grey * random.normal());
    return numbers;
  }();
  return table;
}

}  // namespace

std::vector<std::uint8_t> render(const Environment& environment, const CameraModel& camera, const Rigid3& T_S_C) {
  for (const double k : camera.radtan) RFMVO_ASSERT(k == 0.0);
  const Rigid3 T_C_S = T_S_C.inverse();
  std::vector<Facing> facing;
  for (const Surface& surface : environment.surfaces) {
    Facing f;
    if (face(surface, T_C_S, f)) facing.push_back(std::move(f));
  }
  // Near ones first: what they hide is then never textured.
  std::stable_sort(facing.begin(), facing.end(),
                   [](const Facing& a, const Facing& b) { return a.depth_m < b.depth_m; });
  const std::size_t pixels = static_cast<std::size_t>(camera.width_px) * camera.height_px;
  Target target{camera, std::vector<float>(pixels, kEmpty), std::vector<float>(pixels, 0.0F)};
  for (const Facing& f : facing) draw(f, target);
  std::vector<std::uint8_t> grey(pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    grey[i] = static_cast<std::uint8_t>(std::clamp(target.grey[i] + 0.5F, 0.0F, 255.0F));
  return grey;
}

void add_optics(std::vector<std::uint8_t>& grey, const CameraModel& camera, Random& random) {
  cv::Mat image = as_mat(grey, camera);
  cv::GaussianBlur(image, image, cv::Size(5, 5), kLensBlur_px);
  const std::vector<float>& noise = noise_table();
  std::size_t n = 0;
  for (std::size_t i = 0; i < grey.size(); ++i, ++n) {
    if (i % static_cast<std::size_t>(camera.width_px) == 0) n = random.below(noise.size());
    grey[i] = static_cast<std::uint8_t>(std::clamp(grey[i] + noise[n % noise.size()] + 0.5F, 0.0F, 255.0F));
  }
}

std::shared_ptr<const std::vector<std::uint8_t>> encode_jpeg(const std::vector<std::uint8_t>& grey,
                                                             const CameraModel& camera) {
  auto bytes = std::make_shared<std::vector<std::uint8_t>>();
  std::vector<std::uint8_t> copy = grey;
  const bool done = cv::imencode(".jpg", as_mat(copy, camera), *bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  RFMVO_ASSERT(done);
  return bytes;
}

}  // namespace rfmvo::simulate
