// The same numbers as evo (github.com/MichaelGrupp/evo, PyPI), the field's tool for trajectories, run as
// its command on exported files.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/export_text.hpp"
#include "commands/whole_file.hpp"
#include "evaluate/evaluation.hpp"
#include "odometry/odometry_report.hpp"
#include "support/evaluate_world.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;

std::string output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return "";
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) text.append(buffer.data(), n);
  ::pclose(pipe);
  return text;
}

// evo leaves a zip: stats.json, and the 4x4 matrix of the alignment.
constexpr const char* kReadZip = R"(import io, json, sys, zipfile
import numpy as np
z = zipfile.ZipFile(sys.argv[1])
stats = json.loads(z.read('stats.json'))
names = [n for n in z.namelist() if 'alignment_transformation' in n]
T = np.load(io.BytesIO(z.read(names[0]))) if names else np.eye(4)
print(json.dumps({'rmse': stats['rmse'], 'scale': float(np.cbrt(np.linalg.det(T[:3, :3])))}))
)";

struct EvoNumbers {
  double rmse_m = 0.0;
  double scale = 0.0;
};

class EvoTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(venv_ / "bin/evo_ape")) {
      GTEST_SKIP() << "no evo in " << venv_.string() << " (cmake/install-packages.sh puts it there)";
    }
    fs::create_directories(folder_);
    ASSERT_TRUE(write_whole_file(folder_ / "read_zip.py", kReadZip).ok());
  }

  // HOME: evo keeps its settings there. stdin closed: it asks nothing.
  [[nodiscard]] EvoNumbers ape(const std::string& flags) const { return run_evo("evo_ape", flags); }
  [[nodiscard]] EvoNumbers run_evo(const std::string& tool, const std::string& flags) const {
    std::string name = "result_" + tool + flags + ".zip";
    std::replace(name.begin(), name.end(), ' ', '_');
    const std::string zip = folder_ / name;
    const std::string env = "cd '" + folder_.string() + "' && HOME='" + folder_.string() + "' MPLBACKEND=agg ";
    const std::string log = output_of(env + "'" + (venv_ / "bin" / tool).string() + "' tum truth.tum estimate.tum " +
                                      flags + " --no_warnings --save_results '" + zip + "' 2>&1 </dev/null");
    EXPECT_TRUE(fs::exists(zip)) << log;
    const std::string text = output_of(env + "'" + (venv_ / "bin/python").string() + "' read_zip.py '" + zip + "'");
    const auto json = nlohmann::json::parse(text, nullptr, false);
    EXPECT_TRUE(json.is_object()) << text;
    if (!json.is_object()) return {};
    return {json["rmse"].get<double>(), json["scale"].get<double>()};
  }

  const fs::path venv_ = RFMVO_VENV;
  // One each: ctest runs tests side by side.
  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_ / "evo";
};

constexpr double kRelative = 1e-6;

TEST_F(EvoTest, AgreesOnAteAndScaleOfANoisyPathWithWrongScale) {
  const auto truth = testing::winding_truth(600, 0);
  const auto result = testing::noisy_result(truth, {.T_W_truth = testing::some_motion(), .metric_error = 1.03});
  ASSERT_TRUE(write_whole_file(folder_ / "estimate.tum", to_tum(evaluate::last_of(result))).ok());
  ASSERT_TRUE(write_whole_file(folder_ / "truth.tum", to_tum(evaluate::last_of(testing::perfect_result(truth)))).ok());

  const auto ours = evaluate::evaluate(result, truth).value().trajectory;
  const EvoNumbers se3 = ape("-a"), sim3 = ape("-as");
  ASSERT_GT(se3.rmse_m, 0.02);
  EXPECT_NEAR(*ours.ate_se3_m, se3.rmse_m, kRelative * se3.rmse_m);
  EXPECT_NEAR(*ours.ate_sim3_m, sim3.rmse_m, kRelative * sim3.rmse_m);
  EXPECT_NEAR(ours.segments.at(0).sim3_scale, sim3.scale, kRelative);
}

// The figures of `rfmvo vo` on the files it writes.
TEST_F(EvoTest, AgreesWithTheFiguresOfTheOdometry) {
  const auto truth = testing::winding_truth(600, 0);
  std::vector<odometry::PathPose> path, true_path;
  for (const Estimate& estimate : testing::noisy_result(truth)) {
    const auto* trajectory = std::get_if<Trajectory>(&estimate);
    if (!trajectory) continue;
    for (const MetricPose& p : trajectory->poses) path.push_back({p.time, 0, {p.T_W_C.R, 0.7 * p.T_W_C.t}, {}});
  }
  for (const auto& p : truth.trajectory) true_path.push_back({p.time, 0, {p.T_W_C.R, p.T_W_C.t}, {}});
  ASSERT_TRUE(write_whole_file(folder_ / "estimate.tum", odometry::to_tum(path)).ok());
  ASSERT_TRUE(write_whole_file(folder_ / "truth.tum", odometry::to_tum(true_path)).ok());

  const auto ours = odometry::path_figures(path, truth.trajectory).value();
  const EvoNumbers se3 = run_evo("evo_ape", "-a"), sim3 = run_evo("evo_ape", "-as");
  EXPECT_NEAR(ours.ate_se3_m, se3.rmse_m, kRelative * se3.rmse_m);
  EXPECT_NEAR(ours.ate_sim3_m, sim3.rmse_m, kRelative * sim3.rmse_m);
  EXPECT_NEAR(ours.scale_m_per_unit, sim3.scale, kRelative);
  const EvoNumbers frame = run_evo("evo_rpe", "-as --delta 1");
  EXPECT_NEAR(ours.rpe_frame_m, frame.rmse_m, kRelative * frame.rmse_m);
  const EvoNumbers second = run_evo("evo_rpe", "-as --all_pairs --delta 25");  // frames of 40 ms
  EXPECT_NEAR(ours.rpe_second_m, second.rmse_m, kRelative * second.rmse_m);
  const EvoNumbers turn = run_evo("evo_rpe", "-as --all_pairs --delta 25 -r angle_deg");
  EXPECT_NEAR(ours.rpe_second_deg, turn.rmse_m, 1e-4 * turn.rmse_m + 1e-5);  // evo's angle is an arc cosine
}

}  // namespace
}  // namespace rfmvo
