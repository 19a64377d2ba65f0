#include "simulate/renderer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/assert.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kNear_m = 0.05;
constexpr int kJpegQuality = 90;
constexpr float kEmpty = 40.0F;       // where nothing stands
constexpr double kBlurStep_px = 1.5;  // between two of the instants that make up an exposure
constexpr int kMaxInstants = 6;
constexpr double kBlurProbe_m = 1.5;  // where blur is measured

// A surface in the camera frame with what each pixel needs: 1/z, u and v are rational in the ray (x, y, 1).
struct Facing {
  std::array<Eigen::Vector3d, 4> corners_C;
  Eigen::Vector3d normal_over_d;  // 1/z = normal_over_d . ray
  Eigen::Vector3d right_C, down_C;
  double right_0 = 0, down_0 = 0;  // u = z * right . ray - right_0
  double plane_distance_m = 0;
};

// Seen from the camera as it is when the first row is read and when the last is; between, everything above is
// interpolated: a camera that turns by 0.02 rad meanwhile is off by 0.02 px.
struct Seen {
  const Surface* surface = nullptr;
  Facing first, last;
  double depth_m = 0;  // of the centre, for the drawing order
  bool mover = false;
};

bool face(const Surface& s, const Rigid3& T_C_S, Facing& f) {
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
  f.corners_C = {corner, corner + r, corner + r + b, corner + b};
  return std::any_of(f.corners_C.begin(), f.corners_C.end(), [](const auto& p) { return p.z() > kNear_m; });
}

Facing between(const Facing& a, const Facing& b, double f) {
  Facing m;
  for (std::size_t i = 0; i < 4; ++i) m.corners_C[i] = a.corners_C[i] + f * (b.corners_C[i] - a.corners_C[i]);
  m.normal_over_d = a.normal_over_d + f * (b.normal_over_d - a.normal_over_d);
  m.right_C = a.right_C + f * (b.right_C - a.right_C);
  m.down_C = a.down_C + f * (b.down_C - a.down_C);
  m.right_0 = a.right_0 + f * (b.right_0 - a.right_0);
  m.down_0 = a.down_0 + f * (b.down_0 - a.down_0);
  m.plane_distance_m = a.plane_distance_m + f * (b.plane_distance_m - a.plane_distance_m);
  return m;
}

struct Target {
  const CameraModel& camera;
  std::vector<float> grey, inverse_depth;
  std::vector<char> mover;  // empty: not asked for
};

void draw_span(const Facing& f, const Seen& seen, int y, int x_from, int x_to, Target& target) {
  const CameraModel& c = target.camera;
  const Surface& s = *seen.surface;
  const double ray_y = (y - c.cy_px) / c.fy_px;
  const double ray_x = (x_from - c.cx_px) / c.fx_px, step = 1.0 / c.fx_px;
  const Eigen::Vector3d ray(ray_x, ray_y, 1.0);
  double w = f.normal_over_d.dot(ray), u = f.right_C.dot(ray), v = f.down_C.dot(ray);
  const double dw = f.normal_over_d.x() * step, du = f.right_C.x() * step, dv = f.down_C.x() * step;
  // Texels per pixel: z / f towards the camera, z^2 / (f d) along the slant; between the two.
  const double footprint = s.texels_per_m.maxCoeff() / c.fx_px;
  const auto nearness = static_cast<float>(1.0 / f.plane_distance_m);
  std::size_t i = static_cast<std::size_t>(y) * c.width_px + x_from;
  for (int x = x_from; x <= x_to; ++x, ++i, w += dw, u += du, v += dv) {
    if (w <= target.inverse_depth[i]) continue;
    target.inverse_depth[i] = static_cast<float>(w);
    const double z = 1.0 / w;
    const auto texels = static_cast<float>(footprint * z);
    // Level 0 below 2 texels of 1.4, level 1 below 4, ..: the exponent of the square root is half that of the square.
    const float square = 1.96F * texels * texels * std::max(1.0F, static_cast<float>(z) * nearness);
    const int level = square < 4.0F ? 0 : (static_cast<int>(std::bit_cast<std::uint32_t>(square) >> 23) - 127) / 2;
    const auto tx = static_cast<float>((z * u - f.right_0) * s.texels_per_m.x());
    const auto ty = static_cast<float>((z * v - f.down_0) * s.texels_per_m.y());
    target.grey[i] = s.brightness * s.texture->sample(tx, ty, level);
    if (!target.mover.empty()) target.mover[i] = seen.mover;
  }
}

struct Rows {
  int from, to;
};

// Rows that the surface may touch, seen like this.
Rows rows_of(const Facing& f, const CameraModel& c) {
  double top = 1e9, bottom = -1e9;
  for (const Eigen::Vector3d& p : f.corners_C) {
    if (p.z() <= kNear_m) return {0, c.height_px - 1};
    const double y = c.fy_px * p.y() / p.z() + c.cy_px;
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  return {static_cast<int>(std::ceil(std::clamp(top, 0.0, static_cast<double>(c.height_px)))),
          static_cast<int>(std::floor(std::clamp(bottom, -1.0, c.height_px - 1.0)))};
}

// Where the plane of row y cuts the rectangle: columns from..to; empty if from > to.
Rows columns_of(const Facing& f, int y, const CameraModel& c) {
  const double ray_y = (y - c.cy_px) / c.fy_px;
  std::array<Eigen::Vector3d, 4> ends;  // convex: two, four only if an edge lies in the plane
  std::size_t n = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d &a = f.corners_C[i], &b = f.corners_C[(i + 1) % 4];
    const double ga = a.y() - ray_y * a.z(), gb = b.y() - ray_y * b.z();
    if ((ga <= 0.0) != (gb <= 0.0)) ends[n++] = a + ga / (ga - gb) * (b - a);
  }
  if (n < 2) return {0, -1};
  Eigen::Vector3d &p = ends[0], &q = ends[1];
  if (p.z() < kNear_m && q.z() < kNear_m) return {0, -1};
  if (p.z() < kNear_m) p = q + (q.z() - kNear_m) / (q.z() - p.z()) * (p - q);
  if (q.z() < kNear_m) q = p + (p.z() - kNear_m) / (p.z() - q.z()) * (q - p);
  const double x1 = c.fx_px * p.x() / p.z() + c.cx_px, x2 = c.fx_px * q.x() / q.z() + c.cx_px;
  return {static_cast<int>(std::ceil(std::clamp(std::min(x1, x2), 0.0, static_cast<double>(c.width_px)))),
          static_cast<int>(std::floor(std::clamp(std::max(x1, x2), -1.0, c.width_px - 1.0)))};
}

void draw(const Seen& seen, bool rolling, Target& target) {
  const CameraModel& c = target.camera;
  Rows rows = rows_of(seen.first, c);
  if (rolling) {
    const Rows last = rows_of(seen.last, c);
    rows = {std::min(rows.from, last.from), std::max(rows.to, last.to)};
  }
  for (int y = rows.from; y <= rows.to; ++y) {
    const double share = (y + 0.5) / c.height_px;
    const Facing& f = rolling ? between(seen.first, seen.last, share) : seen.first;
    const Rows columns = columns_of(f, y, c);
    if (columns.from <= columns.to) draw_span(f, seen, y, columns.from, columns.to, target);
  }
}

// T_C_S when the first row is read, and when the last is.
struct CameraView {
  Rigid3 first, last;
  bool rolling;
};

void add_seen(const std::vector<Surface>& surfaces, const CameraView& view, bool mover, std::vector<Seen>& seen) {
  for (const Surface& surface : surfaces) {
    Seen s;
    s.surface = &surface;
    s.mover = mover;
    if (!face(surface, view.first, s.first)) continue;
    if (view.rolling && !face(surface, view.last, s.last)) continue;
    s.depth_m = 0.5 * (s.first.corners_C[0] + s.first.corners_C[2]).z();
    seen.push_back(s);
  }
}

void draw_all(const Environment& environment, const CameraView& view, double t_s, Target& target) {
  std::vector<std::vector<Surface>> moving;
  for (const Mover& mover : environment.movers) {
    const Rigid3 T_S_M = mover.T_S_M(t_s);
    auto& there = moving.emplace_back();
    for (const Surface& s : mover.surfaces) there.push_back(moved(s, T_S_M));
  }
  std::vector<Seen> seen;
  add_seen(environment.surfaces, view, false, seen);
  for (const auto& surfaces : moving) add_seen(surfaces, view, true, seen);
  // Near ones first: what they hide is then never textured.
  std::stable_sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.depth_m < b.depth_m; });
  for (const Seen& s : seen) draw(s, view.rolling, target);
}

Target blank(const CameraModel& camera) {
  for (const double k : camera.radtan) RFMVO_ASSERT(k == 0.0);
  const std::size_t pixels = static_cast<std::size_t>(camera.width_px) * camera.height_px;
  return {camera, std::vector<float>(pixels, kEmpty), std::vector<float>(pixels, 0.0F), {}};
}

std::vector<std::uint8_t> rounded(const std::vector<float>& grey, float factor) {
  std::vector<std::uint8_t> bytes(grey.size());
  for (std::size_t i = 0; i < grey.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(std::clamp(factor * grey[i] + 0.5F, 0.0F, 255.0F));
  return bytes;
}

// How many instants make the exposure smooth: as far as a point at kBlurProbe_m moves.
int instants_of(const CameraModel& camera, const Rigid3& begin, const Rigid3& end) {
  const Eigen::Vector3d p = end.inverse() * (begin * Eigen::Vector3d(0, 0, kBlurProbe_m));
  const double blur_px = camera.fx_px * p.head<2>().norm() / std::max(p.z(), kNear_m);
  return std::clamp(static_cast<int>(std::ceil(blur_px / kBlurStep_px)), 1, kMaxInstants);
}

cv::Mat as_mat(std::vector<std::uint8_t>& grey, const CameraModel& camera) {
  return {camera.height_px, camera.width_px, CV_8UC1, grey.data()};
}

// Normal numbers are dear, a frame needs 300 000: one table of them, read from a random place.
const std::vector<float>& noise_table() {
  static const std::vector<float> table = [] {
    Random random(0, "noise table");
    std::vector<float> numbers(1 << 18);
    for (float& n : numbers) n = static_cast<float>(random.normal());
    return numbers;
  }();
  return table;
}

}  // namespace

std::vector<std::uint8_t> render(const Environment& environment, const CameraModel& camera, const Rigid3& T_S_C) {
  Target target = blank(camera);
  draw_all(environment, {T_S_C.inverse(), {}, false}, 0.0, target);
  return rounded(target.grey, 1.0F);
}

std::vector<std::uint8_t> render_moving(const Environment& environment, const CameraModel& camera,
                                        const std::function<Rigid3(double)>& T_S_C, double t_s,
                                        const CameraEffects& effects) {
  const double half_s = 0.5 * effects.exposure_s;
  const int instants = half_s > 0.0 ? instants_of(camera, T_S_C(t_s - half_s), T_S_C(t_s + half_s)) : 1;
  std::vector<float> sum;
  for (int i = 0; i < instants; ++i) {
    const double now_s = t_s + effects.exposure_s * ((i + 0.5) / instants - 0.5);
    CameraView view{T_S_C(now_s - 0.5 * effects.readout_s).inverse(), {}, effects.readout_s != 0.0};
    if (view.rolling) view.last = T_S_C(now_s + 0.5 * effects.readout_s).inverse();
    Target target = blank(camera);
    draw_all(environment, view, now_s, target);
    if (sum.empty()) {
      sum.swap(target.grey);
    } else {
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += target.grey[k];
    }
  }
  return rounded(sum, 1.0F / static_cast<float>(instants));
}

double occluded_share(const Environment& environment, const CameraModel& camera, const Rigid3& T_S_C, double t_s) {
  Target target = blank(camera);
  target.mover.assign(target.grey.size(), 0);
  draw_all(environment, {T_S_C.inverse(), {}, false}, t_s, target);
  const auto covered = std::count(target.mover.begin(), target.mover.end(), 1);
  return static_cast<double>(covered) / static_cast<double>(target.mover.size());
}

void add_optics(std::vector<std::uint8_t>& grey, const CameraModel& camera, const CameraEffects& effects, double t_s,
                Random& random) {
  cv::Mat image = as_mat(grey, camera);
  cv::GaussianBlur(image, image, cv::Size(5, 5), effects.lens_blur_px);
  const std::vector<float>& noise = noise_table();
  const auto gain = static_cast<float>(effects.gain ? effects.gain(t_s) : 1.0);
  const auto sigma = static_cast<float>(effects.noise_grey), dark = static_cast<float>(effects.vignetting);
  const float cx = 0.5F * static_cast<float>(camera.width_px), cy = 0.5F * static_cast<float>(camera.height_px);
  const float corner2 = cx * cx + cy * cy;
  std::size_t i = 0;
  for (int y = 0; y < camera.height_px; ++y) {
    std::size_t n = random.below(noise.size() - static_cast<std::size_t>(camera.width_px));
    const float dy = static_cast<float>(y) - cy;
    for (int x = 0; x < camera.width_px; ++x, ++i, ++n) {
      const float dx = static_cast<float>(x) - cx;
      const float light = gain * (1.0F - dark * (dx * dx + dy * dy) / corner2);
      const float value = light * static_cast<float>(grey[i]) + sigma * noise[n] + 0.5F;
      grey[i] = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
    }
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
