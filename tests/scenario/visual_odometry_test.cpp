// The odometry on pictures whose truth is known (rendered walls), and on real image sequences.
#include "vision/visual_odometry.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>

#include "base/units.hpp"
#include "odometry/path_figures.hpp"
#include "support/textured_scene.hpp"

namespace rfmvo {
namespace {

constexpr double kRate_hz = 30.0;

CameraModel test_camera() {
  CameraModel camera;
  camera.width_px = 480, camera.height_px = 360;
  camera.fx_px = camera.fy_px = 390.0;
  camera.cx_px = 239.5, camera.cy_px = 179.5;
  return camera;
}

// A flat wall 1.5 m ahead, 9 m long: what a cart sees that passes it looking sideways.
std::vector<TexturedPlane> wall() { return {{texture(2340, 780, 21), {-2.0, -1.5, 1.5}, {9.0, 0, 0}, {0, 3.0, 0}}}; }

// A shelf: the back wall, and boards 0.4 m before it.
std::vector<TexturedPlane> shelf() {
  auto planes = wall();
  for (const double y : {-0.55, 0.05, 0.65}) {
    planes.push_back(
        {texture(2340, 50, static_cast<std::uint64_t>(100 + 10 * y)), {-2.0, y, 1.1}, {9.0, 0, 0}, {0, 0.19, 0}});
  }
  return planes;
}

using Path = std::function<Rigid3(double)>;  // T_W_C at a time in s

Rigid3 pass(double t, double speed_m_s) {
  const Eigen::Vector3d p(speed_m_s * t, 0.02 * std::sin(2.0 * t), 0.03 * std::sin(1.3 * t));
  return {so3_exp({0.01 * std::sin(3.0 * t), 0.05 * std::sin(1.1 * t), 0.01 * std::sin(1.7 * t)}), p};
}

struct Sequence {
  std::vector<CameraPose> poses;
  std::vector<Eigen::Vector3d> truth_W;
};

using Change = std::function<void(cv::Mat&, double)>;  // of a picture, before the odometry sees it

Sequence run(const std::vector<TexturedPlane>& scene, double duration_s, const Path& path, const Change& change = {}) {
  const CameraModel camera = test_camera();
  VisualOdometry odometry(VisionConfig{}, camera);
  Sequence s;
  for (int i = 0; i < static_cast<int>(duration_s * kRate_hz); ++i) {
    const double t = i / kRate_hz;
    cv::Mat image = render(scene, camera, path(t));
    if (change) change(image, t);
    s.poses.push_back(odometry.on(frame_of(image, t, i)));
    s.truth_W.push_back(path(t).t);
  }
  return s;
}

bool has_pose(const CameraPose& p) { return p.status == VoStatus::kTracking || p.status == VoStatus::kDegraded; }

std::set<std::uint32_t> segments(const Sequence& s) {
  std::set<std::uint32_t> ids;
  for (const auto& p : s.poses) {
    if (has_pose(p)) ids.insert(p.segment);
  }
  return ids;
}

struct Accuracy {
  double error_share = 1.0;    // rms after the best similarity, of the path's length
  double tracked_share = 0.0;  // of the frames from the first pose on
  double start_s = 1e9;
};

Accuracy accuracy(const Sequence& s) {
  std::vector<std::size_t> with;
  for (std::size_t i = 0; i < s.poses.size(); ++i) {
    if (has_pose(s.poses[i])) with.push_back(i);
  }
  if (with.size() < 3) return {};
  Eigen::Matrix3Xd a(3, with.size()), b(3, with.size());
  double length = 0.0;
  for (std::size_t k = 0; k < with.size(); ++k) {
    a.col(static_cast<Eigen::Index>(k)) = s.poses[with[k]].T_V_C.p_V_C;
    b.col(static_cast<Eigen::Index>(k)) = s.truth_W[with[k]];
    if (k > 0) length += (s.truth_W[with[k]] - s.truth_W[with[k - 1]]).norm();
  }
  const Eigen::Matrix4d T = Eigen::umeyama(a, b, true);
  const Eigen::Matrix3Xd d = ((T.topLeftCorner<3, 3>() * a).colwise() + T.topRightCorner<3, 1>()) - b;
  Accuracy result;
  result.error_share = std::sqrt(d.squaredNorm() / static_cast<double>(with.size())) / length;
  result.tracked_share = static_cast<double>(with.size()) / static_cast<double>(s.poses.size() - with.front());
  result.start_s = (s.poses[with.front()].time - s.poses.front().time).seconds();
  return result;
}

void expect_equal_bits(const Sequence& a, const Sequence& b) {
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].status, b.poses[i].status);
    EXPECT_EQ(a.poses[i].T_V_C.p_V_C, b.poses[i].T_V_C.p_V_C);
    EXPECT_EQ(a.poses[i].T_V_C.R_V_C.coeffs(), b.poses[i].T_V_C.R_V_C.coeffs());
    EXPECT_EQ(a.poses[i].motion_covariance, b.poses[i].motion_covariance);
  }
}

// A camera whose calibration states no distortion, though there is one.
Lens lens_after(const std::vector<TexturedPlane>& scene, const Path& path, double k1, double readout_s) {
  CameraModel told = test_camera(), real = told;
  real.radtan[0] = k1;
  VisualOdometry odometry(VisionConfig{}, told);
  for (int i = 0; i < static_cast<int>(5.0 * kRate_hz); ++i) {
    const double t = i / kRate_hz;
    const cv::Mat image =
        readout_s > 0.0 ? render_rolling(scene, real, path, t, readout_s) : render(scene, real, path(t));
    (void)odometry.on(frame_of(image, t, i));
  }
  return odometry.lens();
}

Rigid3 shaken_pass(double t) {
  Rigid3 T = pass(t, 0.6);
  T.R = T.R * so3_exp({0.06 * std::sin(4.1 * t), 0.08 * std::sin(3.3 * t), 0.04 * std::sin(2.9 * t)});
  return T;
}

TEST(VisualOdometry, LearnsTheLensThatTheCalibrationKeptQuiet) {
  for (const double k1 : {-0.06, 0.0, 0.06}) {
    const Lens lens = lens_after(shelf(), shaken_pass, k1, 0.0);
    EXPECT_NEAR(lens.camera().radtan[0], k1, 0.02);  // VISION design: 0.1 bends 5.5 m of path by 15 degrees
    EXPECT_NEAR(lens.readout_s(), 0.0, 0.002);
  }
}

TEST(VisualOdometry, LearnsTheRollingShutter) {
  const Lens lens = lens_after(shelf(), shaken_pass, 0.0, 0.03);
  EXPECT_NEAR(lens.readout_s(), 0.03, 0.003);
  EXPECT_NEAR(lens.camera().radtan[0], 0.0, 0.01);
}

// A flat wall passed sideways at constant speed: a leaning picture may be a leaning wall.
TEST(VisualOdometry, DoesNotInventALensBeforeAFlatWall) {
  const Lens lens = lens_after(
      wall(),
      [](double t) {
        return Rigid3{Eigen::Quaterniond::Identity(), {0.6 * t, 0.0, 0.0}};
      },
      0.0, 0.0);
  EXPECT_NEAR(lens.camera().radtan[0], 0.0, 0.01);
  EXPECT_NEAR(lens.readout_s(), 0.0, 0.003);
}

class Pass : public testing::TestWithParam<std::tuple<bool, double>> {};

TEST_P(Pass, IsTrackedInOneSegment) {
  const auto [flat, speed_m_s] = GetParam();
  const Sequence s = run(flat ? wall() : shelf(), 3.0 / speed_m_s, [v = speed_m_s](double t) { return pass(t, v); });
  const Accuracy a = accuracy(s);
  EXPECT_LT(a.start_s, 1.0);
  EXPECT_GE(a.tracked_share, 0.98);
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(a.error_share, 0.004);  // prototype on renders: 0.03..0.05 % over 5.5 m; short passes start badly
}

INSTANTIATE_TEST_SUITE_P(WallsAndShelves, Pass, testing::Combine(testing::Bool(), testing::Values(0.5, 1.0)));

TEST(VisualOdometry, SameFramesGiveTheSameBits) {
  const auto once = [] { return run(shelf(), 2.0, [](double t) { return pass(t, 0.7); }); };
  expect_equal_bits(once(), once());
}

TEST(VisualOdometry, OneThreadOrTwoGiveTheSameBits) {
  const auto with = [](int threads) {
    cv::setNumThreads(threads);
    return run(shelf(), 2.0, [](double t) { return pass(t, 0.7); });
  };
  const Sequence one = with(1), two = with(2);
  cv::setNumThreads(1);
  expect_equal_bits(one, two);
}

TEST(VisualOdometry, BrighterPicturesGiveTheSamePath) {
  const auto path = [](double t) { return pass(t, 0.7); };
  const Sequence plain = run(shelf(), 3.0, path);
  const Sequence dim = run(shelf(), 3.0, path, [](cv::Mat& image, double) { image *= 0.8; });
  EXPECT_LT(accuracy(plain).error_share, 0.004);
  EXPECT_LT(accuracy(dim).error_share, 0.004);
}

// Metres and pixels are not related: a scene twice as large, passed twice as fast, is the same film.
TEST(VisualOdometry, ScaledSceneLeavesThePathInVUnchanged) {
  static constexpr double kScale = 2.0;  // a power of two: scaling is exact
  auto large = shelf();
  for (auto& plane : large) plane.corner_W *= kScale, plane.width_W *= kScale, plane.height_W *= kScale;
  const Sequence a = run(shelf(), 2.0, [](double t) { return pass(t, 0.7); });
  const Sequence b = run(large, 2.0, [](double t) {
    Rigid3 T = pass(t, 0.7);
    T.t *= kScale;
    return T;
  });
  expect_equal_bits(a, b);
}

TEST(VisualOdometry, PureRotationNeverMakesAMap) {
  const Sequence s = run(shelf(), 4.0, [](double t) {
    return Rigid3{so3_exp({0.05 * std::sin(1.7 * t), 0.35 * std::sin(0.9 * t), 0.0}), {1.0, 0.0, 0.0}};
  });
  for (const auto& p : s.poses) EXPECT_EQ(p.status, VoStatus::kInitialising);
}

TEST(VisualOdometry, StandstillFromTheStartNeverMakesAMap) {
  cv::RNG noise(5);
  const Sequence s = run(
      shelf(), 2.0, [](double) { return Rigid3{}; },
      [&noise](cv::Mat& image, double) {
        cv::Mat grain(image.size(), CV_16SC1), sum;
        noise.fill(grain, cv::RNG::NORMAL, 0.0, 3.0);
        image.convertTo(sum, CV_16SC1);
        sum += grain;
        sum.convertTo(image, CV_8UC1);
      });
  for (const auto& p : s.poses) EXPECT_EQ(p.status, VoStatus::kInitialising);
}

TEST(VisualOdometry, StandstillAfterAPassHardlyDrifts) {
  cv::RNG noise(6);
  static constexpr double kStop_s = 2.0;
  const Sequence s = run(
      shelf(), 6.0, [](double t) { return pass(std::min(t, kStop_s), 0.7); },
      [&noise](cv::Mat& image, double) {
        cv::Mat grain(image.size(), CV_16SC1), sum;
        noise.fill(grain, cv::RNG::NORMAL, 0.0, 3.0);
        image.convertTo(sum, CV_16SC1);
        sum += grain;
        sum.convertTo(image, CV_8UC1);
      });
  EXPECT_EQ(segments(s).size(), 1U);
  const auto stopped = static_cast<std::size_t>((kStop_s + 0.2) * kRate_hz);
  const Eigen::Vector3d p = s.poses[stopped].T_V_C.p_V_C;
  for (std::size_t i = stopped; i < s.poses.size(); ++i) {
    ASSERT_TRUE(has_pose(s.poses[i])) << i;
    // One unit of V is about 1.4 m here. Measured on real pictures: 0.13 mm; 5 mm is a jump.
    EXPECT_LT((s.poses[i].T_V_C.p_V_C - p).norm(), 0.0035) << i;
  }
}

TEST(VisualOdometry, BlackPicturesAreLostAndANewSegmentStartsAfterThem) {
  constexpr double kFrom_s = 2.0, kTo_s = 3.8;  // longer than the map is kept
  const Sequence s = run(
      shelf(), 6.5, [](double t) { return pass(t, 0.7); },
      [=](cv::Mat& image, double t) {
        if (t >= kFrom_s && t < kTo_s) image.setTo(0);
      });
  for (const auto& p : s.poses) {
    const double t = Duration{p.time.ns}.seconds();
    if (t >= kFrom_s + 0.3 && t < kTo_s) {
      EXPECT_EQ(p.status, VoStatus::kLost) << t;
    }
    if (t >= kFrom_s && t < kTo_s) {
      EXPECT_FALSE(has_pose(p)) << t;
    }
    if (t >= kTo_s + 2.0) {
      EXPECT_TRUE(has_pose(p)) << t;
    }
  }
  EXPECT_EQ(segments(s).size(), 2U);
}

// How far the camera went between two times, in V, for a metre of the truth.
double scale_between(const Sequence& s, double from_s, double to_s) {
  const auto a = static_cast<std::size_t>(from_s * kRate_hz), b = static_cast<std::size_t>(to_s * kRate_hz);
  return (s.poses[b].T_V_C.p_V_C - s.poses[a].T_V_C.p_V_C).norm() / (s.truth_W[b] - s.truth_W[a]).norm();
}

// Half a metre passes unseen; most of the scene is still there.
TEST(VisualOdometry, AShortBlackoutKeepsSegmentAndScale) {
  constexpr double kFrom_s = 2.0, kTo_s = 2.9;
  const Sequence s = run(
      shelf(), 5.0, [](double t) { return pass(t, 0.5); },
      [=](cv::Mat& image, double t) {
        if (t >= kFrom_s && t < kTo_s) image.setTo(0);
      });
  for (const auto& p : s.poses) {
    const double t = Duration{p.time.ns}.seconds();
    if (t >= kFrom_s && t < kTo_s) {
      EXPECT_FALSE(has_pose(p)) << t;
    }
    if (t >= kTo_s + 0.2) {
      EXPECT_EQ(p.status, VoStatus::kTracking) << t;
    }
  }
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(accuracy(s).error_share, 0.004);
  EXPECT_NEAR(scale_between(s, 1.9, 3.2) / scale_between(s, 1.0, 1.9), 1.0, 0.02);
}

// The same blackout, but what is seen after it is another wall.
TEST(VisualOdometry, AnotherSceneAfterABlackoutIsAnotherSegment) {
  constexpr double kFrom_s = 2.0, kTo_s = 2.9;
  auto other = shelf();
  for (std::size_t i = 0; i < other.size(); ++i)
    other[i].picture = texture(other[i].picture.cols, other[i].picture.rows, 900 + i);
  const CameraModel camera = test_camera();
  VisualOdometry odometry(VisionConfig{}, camera);
  Sequence s;
  for (int i = 0; i < 150; ++i) {
    const double t = i / kRate_hz;
    cv::Mat image = render(t < kTo_s ? shelf() : other, camera, pass(t, 0.5));
    if (t >= kFrom_s && t < kTo_s) image.setTo(0);
    s.poses.push_back(odometry.on(frame_of(image, t, i)));
    s.truth_W.push_back(pass(t, 0.5).t);
  }
  EXPECT_EQ(segments(s).size(), 2U);
  EXPECT_EQ(s.poses.back().status, VoStatus::kTracking);
}

TEST(VisualOdometry, OneDarkFrameDoesNotBreakTheSegment) {
  const Sequence s = run(
      shelf(), 3.0, [](double t) { return pass(t, 0.5); },
      [](cv::Mat& image, double t) {
        if (t >= 2.0 && t < 2.03) image.setTo(0);
      });
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(accuracy(s).error_share, 0.004);
}

// Summed over a second, as whoever uses it does, the published covariance must be as large as the motion's real error.
TEST(VisualOdometry, MotionCovarianceOfASecondIsHonest) {
  const Path path = [](double t) { return pass(t, 0.6); };
  const Sequence s = run(shelf(), 6.0, path);
  std::vector<odometry::PathPose> poses;
  std::vector<simulate::TruePose> truth;
  for (std::size_t i = 0; i < s.poses.size(); ++i) {
    const CameraPose& p = s.poses[i];
    truth.push_back({p.time, path(Duration{p.time.ns}.seconds())});
    if (has_pose(p)) poses.push_back({p.time, p.segment, p.T_V_C, p.motion_covariance});
  }
  const auto figures = odometry::path_figures(poses, truth);
  ASSERT_TRUE(figures && figures->nees);
  RecordProperty("nees_per_dof", std::to_string(*figures->nees));
  // 1 if exact; five seconds hold few independent errors, and in the first of them the lens is not confirmed yet.
  // Measured: 0.31.
  EXPECT_GT(*figures->nees, 0.2);
  EXPECT_LT(*figures->nees, 2.0);
}

void expect_status_during(const Sequence& s, double from_s, double to_s, std::set<VoStatus> allowed) {
  for (const auto& p : s.poses) {
    const double t = Duration{p.time.ns}.seconds();
    if (t < from_s || t >= to_s) continue;
    EXPECT_TRUE(allowed.contains(p.status)) << t << " s: " << static_cast<int>(p.status);
  }
}

void fill_with_noise(cv::Mat& image, double grey, double sigma, cv::RNG& random) {
  cv::Mat grain(image.size(), CV_16SC1);
  random.fill(grain, cv::RNG::NORMAL, grey, sigma);
  grain.convertTo(image, CV_8UC1);
}

// Two seconds of nothing to see: lost within 0.3 s, nothing pretended, a new segment within 2 s.
class Blindness : public testing::TestWithParam<double> {};

TEST_P(Blindness, IsLostAndANewSegmentStartsAfterwards) {
  constexpr double kFrom_s = 2.0, kTo_s = 4.0;
  cv::RNG random(9);
  const Sequence s = run(
      shelf(), 7.0, [](double t) { return pass(t, 0.6); },
      [&](cv::Mat& image, double t) {
        if (t >= kFrom_s && t < kTo_s) fill_with_noise(image, GetParam(), 2.0, random);
      });
  expect_status_during(s, 1.5, kFrom_s, {VoStatus::kTracking});
  expect_status_during(s, kFrom_s, kTo_s, {VoStatus::kLost});
  expect_status_during(s, kTo_s + 2.0, 7.0, {VoStatus::kTracking});
  EXPECT_EQ(segments(s).size(), 2U);
}

// Black, a blank wall, overexposed.
INSTANTIATE_TEST_SUITE_P(Greys, Blindness, testing::Values(0.0, 120.0, 255.0));

TEST(VisualOdometry, ABlankWallNeverMakesAMap) {
  cv::RNG random(10);
  const Sequence s = run(
      wall(), 2.0, [](double t) { return pass(t, 0.6); },
      [&](cv::Mat& image, double) { fill_with_noise(image, 120.0, 2.0, random); });
  for (const auto& p : s.poses) EXPECT_FALSE(has_pose(p));
}

TEST(VisualOdometry, PicturesThatHangMakeNoMotionAndAreNotVouchedFor) {
  constexpr double kFrom_s = 2.0, kTo_s = 3.0;
  cv::Mat kept;
  const Sequence s = run(
      shelf(), 6.0, [](double t) { return pass(t, 0.6); },
      [&](cv::Mat& image, double t) {
        if (t >= kFrom_s && t < kTo_s) image = kept.clone();
        kept = image.clone();
      });
  expect_status_during(s, kFrom_s + 0.05, kTo_s, {VoStatus::kDegraded});
  const auto at = [&s](double t) { return s.poses[static_cast<std::size_t>(t * kRate_hz)].T_V_C.p_V_C; };
  EXPECT_LT((at(kTo_s - 0.1) - at(kFrom_s + 0.1)).norm(), 1e-12);
  expect_status_during(s, kTo_s + 2.0, 6.0, {VoStatus::kTracking});
  EXPECT_EQ(segments(s).size(), 1U);  // 0.6 m were missed; the map still knows what comes
  EXPECT_NEAR(scale_between(s, 1.9, 3.5) / scale_between(s, 1.0, 1.9), 1.0, 0.02);
}

TEST(VisualOdometry, TheLightMayTripleAtOnce) {
  const Sequence s = run(
      shelf(), 4.0, [](double t) { return pass(t, 0.5); },
      [](cv::Mat& image, double t) { image = t < 2.0 ? image * 0.3 : image * 0.9; });
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(accuracy(s).error_share, 0.004);
}

TEST(VisualOdometry, AFisheyeLensGivesTheSamePath) {
  CameraModel camera = test_camera();
  camera.fx_px = camera.fy_px = 230.0;  // 120 degrees across
  camera.distortion = Distortion::kEquidistant;
  camera.equidistant = {-0.02, 0.005, -0.003, 0.0005};
  VisualOdometry odometry(VisionConfig{}, camera);
  auto scene = shelf();
  for (auto& plane : scene) plane.corner_W.x() -= 1.5;  // it sees more to the left
  Sequence s;
  for (int i = 0; i < 120; ++i) {
    const double t = i / kRate_hz;
    s.poses.push_back(odometry.on(frame_of(render(scene, camera, pass(t, 0.6)), t, i)));
    s.truth_W.push_back(pass(t, 0.6).t);
  }
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(accuracy(s).error_share, 0.004);
}

TEST(VisualOdometry, SettledPosesCoverTheLivePathAndAreNoWorse) {
  const Path path = [](double t) { return pass(t, 0.6); };
  VisualOdometry odometry(VisionConfig{}, test_camera());
  Sequence live, settled;
  const auto keep = [&](std::span<const SettledPose> poses) {
    for (const SettledPose& p : poses) {
      settled.poses.push_back({.time = p.time, .segment = p.segment, .status = VoStatus::kTracking, .T_V_C = p.T_V_C});
      settled.truth_W.push_back(path(Duration{p.time.ns}.seconds()).t);
    }
  };
  for (int i = 0; i < 150; ++i) {
    const double t = i / kRate_hz;
    live.poses.push_back(odometry.on(frame_of(render(shelf(), test_camera(), path(t)), t, i)));
    live.truth_W.push_back(path(t).t);
    for (const SettledPose& p : odometry.settled()) {
      EXPECT_GE(live.poses.back().time - p.time, SettledPath::kSettleLag);
    }
    keep(odometry.settled());
  }
  const std::vector<SettledPose> rest = odometry.finish();
  keep(rest);
  const auto with_pose = std::count_if(live.poses.begin(), live.poses.end(), has_pose);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(settled.poses.size()), with_pose);
  EXPECT_LT(accuracy(settled).error_share, 1.2 * accuracy(live).error_share);
}

TEST(VisualOdometry, WrongSizeIsLost) {
  VisualOdometry odometry(VisionConfig{}, test_camera());
  EXPECT_EQ(odometry.on(frame_of(texture(100, 80, 1), 0.0, 0)).status, VoStatus::kLost);
  EXPECT_EQ(odometry.on(Frame{}).status, VoStatus::kLost);
}

namespace fs = std::filesystem;

Sequence run_folder(const fs::path& dir) {
  CameraModel camera;
  std::ifstream calib(dir / "calib.txt"), times(dir / "times.txt"), truth(dir / "groundtruth.txt");
  std::string line, model;
  while (std::getline(calib, line) && line[0] == '#') {
  }
  std::istringstream fields(line);
  fields >> camera.fx_px >> camera.fy_px >> camera.cx_px >> camera.cy_px >> camera.width_px >> camera.height_px >>
      model;
  for (double& k : camera.radtan) fields >> k;
  std::map<long, Eigen::Vector3d> positions;  // by rounded ms
  while (std::getline(truth, line)) {
    double t = 0, x = 0, y = 0, z = 0;
    if (std::istringstream(line) >> t >> x >> y >> z) positions[std::lround(1e3 * t)] = {x, y, z};
  }
  VisualOdometry odometry(VisionConfig{}, camera);
  Sequence s;
  while (std::getline(times, line)) {
    double t = 0;
    std::string name;
    if (!(std::istringstream(line) >> t >> name)) continue;
    const CameraPose pose = odometry.on(frame_of(cv::imread((dir / name).string(), cv::IMREAD_GRAYSCALE), t, 0));
    const auto p = positions.find(std::lround(1e3 * t));
    if (p == positions.end()) continue;
    s.poses.push_back(pose);
    s.truth_W.push_back(p->second);
  }
  return s;
}

TEST(VisualOdometryRealData, HandheldKitchen) {
  const fs::path dir = fs::path(RFMVO_TEST_DATA) / "7scenes-a";
  if (!fs::exists(dir)) GTEST_SKIP() << dir << " is absent";
  const Sequence s = run_folder(dir);
  const Accuracy a = accuracy(s);
  EXPECT_LT(a.start_s, 1.5);
  EXPECT_GE(a.tracked_share, 0.98);
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(a.error_share, 0.013);
}

TEST(VisualOdometryRealData, SliderLookingSideways) {
  const fs::path dir = fs::path(RFMVO_TEST_DATA) / "davis-slider-depth";
  if (!fs::exists(dir)) GTEST_SKIP() << dir << " is absent";
  const Sequence s = run_folder(dir);
  const Accuracy a = accuracy(s);
  EXPECT_GE(a.tracked_share, 0.9);
  EXPECT_EQ(segments(s).size(), 1U);
  EXPECT_LT(a.error_share, 0.005);
}

}  // namespace
}  // namespace rfmvo
