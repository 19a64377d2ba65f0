#include "support/sample_events.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "edges/journal.hpp"

namespace rfmvo::testing {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "rfmvo-test-XXXXXX").string();
  EXPECT_NE(mkdtemp(pattern.data()), nullptr);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

void write_file(const std::string& path, const std::string& bytes) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

Calibration sample_calibration() {
  Calibration c;
  c.camera = {640, 480, 501.1, 502.2 + 1e-13, 319.5, 0.1 + 0.2, {-0.28, 0.07, 1e-4, 1.0 / 3.0, 0.0}};
  c.T_B_C = {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d(0.1, -1.0 / 3.0, 1e-17)};
  c.antennas.push_back({1, {0.25, -0.1, 1.0 / 7.0}, Eigen::Vector3d(0.1, 0.2, 0.9).normalized(), {0.005, 1.0 / 3.0, 0.0},
                        7.0 / 3.0, 0.1});
  c.antennas.push_back({2, {-0.25, 0.3, 0.0}, {0.0, 0.0, 1.0}, Eigen::Vector3d::Constant(1.0 / 300.0)});
  return c;
}

Start sample_start() {
  Start start;
  start.time = DeviceTime::from_us(1'700'000'000'000'000);
  start.config.estimator.pose_source = "poses";
  start.config.joint.structured_sigma_rad = 0.1 + 0.2;
  start.calibration = sample_calibration();
  return start;
}

namespace {

CameraPose sample_pose(DeviceTime time) {
  CameraPose pose;
  pose.time = time;
  pose.segment = 3;
  pose.status = VoStatus::kTracking;
  pose.inliers = 77;
  pose.T_V_C = {Eigen::Quaterniond(1, 0.1, -0.2, 0.3).normalized(), {1.0 / 3.0, -2.0, 1e-300}};
  pose.motion_covariance = 1e-6 / 3.0 * Eigen::Matrix<double, 6, 6>::Identity();
  pose.motion_covariance(0, 5) = 1e-9;
  return pose;
}

TagRead sample_read(DeviceTime time) {
  TagRead read;
  read.time = time;
  read.reader_time = ReaderTime::from_us(946'684'800'000'123);  // the reader believes it is the year 2000
  read.epc = Epc::from_hex("E28011602000600D3CA80AE1").value();
  read.port = 2;
  read.phase = {65535};
  read.frequency_hz = 920'625'000;
  read.rssi_cdbm = -5512;
  read.seen_count = 1;
  read.doppler_hz_q4 = -273;
  return read;
}

ReaderStatus sample_reader_status(DeviceTime time) {
  return {time, true, true, 820'454'400.25, -1.5e-5, 3e-4, 2, 3, std::uint64_t{1} << 33};
}

MetricPose sample_metric_pose(DeviceTime time) {
  MetricPose pose;
  pose.time = time;
  pose.segment = 1;
  pose.map_revision = 4;
  pose.T_W_C = {Eigen::Quaterniond(0.3, 0.1, -0.2, 0.3).normalized(), {1.0 / 3.0, 2.0, -3.0}};
  pose.covariance(1, 4) = 0.1;
  return pose;
}

}  // namespace

std::vector<Event> one_of_each_event() {
  const Start start = sample_start();
  const auto at = [&](std::int64_t ms) { return start.time + Duration{ms * 1'000'000}; };
  std::vector<std::uint8_t> pixels(8 * 6);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(5 * i);
  Frame frame;
  frame.time = at(1);
  frame.sequence = 41;
  frame.width_px = 8;
  frame.height_px = 6;
  frame.grey = std::make_shared<const std::vector<std::uint8_t>>(pixels);
  return {start,      frame, sample_pose(at(2)), sample_read(at(3)), Tick{at(4)}, Fault{at(5), "reader", "no answer"},
          sample_reader_status(at(6)), Command{at(7), "stop", ""}};
}

std::vector<Estimate> one_of_each_estimate() {
  const DeviceTime time = DeviceTime::from_us(1'700'000'000'000'000);
  TagEstimate tag;
  tag.time = time;
  tag.epc = sample_read(time).epc;
  tag.status = TagStatus::kMirror;
  tag.segment = 2;
  tag.map_revision = 9;
  tag.p_W_X_m = {0.1, 0.2, 1.0 / 3.0};
  tag.covariance_m2 << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  tag.covariance_with_log_scale_m = {1e-3, -1e-4, 0};
  tag.closest_approach = DeviceTime::from_us(12);
  tag.p_C_X_m = {4, 5, 6};
  tag.covariance_C_m2 = 0.25 * Eigen::Matrix3d::Identity();
  tag.hdop = 1.5;
  tag.bearing_sweep_rad = 0.7;
  tag.independent_reads = 12.25;
  tag.reads = 300;
  tag.hypotheses = {{tag.p_W_X_m, tag.covariance_m2, 0.75}, {{-1, 0, 0}, Eigen::Matrix3d::Identity(), 0.25}};
  Trajectory trajectory{time, 1, 4, {sample_metric_pose(time), sample_metric_pose(time + Duration{1'000'000})}};
  Health health;
  health.time = time;
  health.vo_status = VoStatus::kLost;
  health.reads = std::uint64_t{1} << 40;
  health.tags = 7;
  health.last_fault = "camera: gone";
  health.reader = sample_reader_status(time);
  return {sample_pose(time), tag,   ScaleEstimate{time, 1, true, 1.0 / 3.0, 0.01}, sample_metric_pose(time), trajectory,
          MapRevision{time, 5, "scale corrected"}, health};
}

std::vector<Event> short_run(int poses) {
  Start start = sample_start();
  start.calibration.camera = {8, 6, 10, 10, 3.5, 2.5, {}};
  std::vector<Event> events{start};
  for (int i = 0; i < poses; ++i) {
    const DeviceTime time = start.time + Duration{i * std::int64_t{100'000'000}};
    CameraPose pose = sample_pose(time);
    pose.T_V_C = {so3_exp({0, 0.01 * i, 0}), {0.05 * i, 0.0, 0.002 * i}};
    events.push_back(pose);
    TagRead read = sample_read(time + Duration{37'000'000});
    read.epc = Epc::from_hex(i % 2 == 0 ? "AA01" : "AA02").value();
    read.port = static_cast<std::uint8_t>(1 + i % 2);
    const double range_m = std::hypot(2.0, 0.1 * i - 1.0);
    read.phase = Phase::from_rad(4.0 * kPi * range_m * read.frequency_hz / kSpeedOfLight_m_s);
    events.push_back(read);
  }
  events.push_back(Tick{time_of(events.back()) + Duration{200'000'000}});
  return events;
}

void write_journal(const std::string& path, const std::vector<Event>& events) {
  auto writer = LogWriter::create(path, LcmConfig{}.prefix);
  ASSERT_TRUE(writer.ok()) << writer.error().text();
  for (const Event& event : events) ASSERT_TRUE(writer.value()->write(event).ok());
  ASSERT_TRUE(writer.value()->close().ok());
}

CommandResult run_command(const std::string& command) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::string err = folder / "err";
  const int status = std::system(("( " + command + " ) >'" + out + "' 2>'" + err + "'").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
}

}  // namespace rfmvo::testing
