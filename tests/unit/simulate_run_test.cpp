// Whole runs: the order and the reproducibility of the events, and what W and V mean.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "edges/lcm_codec.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

struct SimulatedRun {
  std::vector<Event> events;
  Truth truth;
};

SimulatedRun run(Options options) {
  SimulatedRun r;
  auto truth = simulate(options, [&](const Event& event) -> Status {
    r.events.push_back(event);
    return Done{};
  });
  EXPECT_TRUE(truth.ok());
  r.truth = truth.value();
  return r;
}

SimulatedRun run(const std::string& scene, std::uint64_t seed, const std::string& vo_class = "NOMINAL") {
  Options options;
  options.scene = scene;
  options.seed = seed;
  options.vo_class = vo_class;
  options.frames = false;
  return run(options);
}

std::vector<std::uint8_t> bytes_of(const std::vector<Event>& events) {
  std::vector<std::uint8_t> bytes;
  for (const Event& event : events) {
    const LcmMessage message = encode(event, "T_");
    bytes.insert(bytes.end(), message.channel.begin(), message.channel.end());
    bytes.insert(bytes.end(), message.data.begin(), message.data.end());
  }
  return bytes;
}

// The first `count_s` seconds; rendering a whole drive would only cost time.
std::vector<Event> beginning(Options options, double length_s) {
  std::vector<Event> events;
  const auto ended = simulate(options, [&](const Event& event) -> Status {
    if (!events.empty() && (time_of(event) - time_of(events.front())).seconds() > length_s) return Error{};
    events.push_back(event);
    return Done{};
  });
  EXPECT_FALSE(ended.ok());  // the sink's error ends the run
  return events;
}

TEST(Simulate, SameSeedGivesTheSameBytes) {
  for (const std::string& scene : scene_names()) {
    EXPECT_EQ(bytes_of(run(scene, 3).events), bytes_of(run(scene, 3).events)) << scene;
  }
}

TEST(Simulate, RenderedFramesAreReproducible) {
  Options options;
  options.scene = "aisle";
  EXPECT_EQ(bytes_of(beginning(options, 0.4)), bytes_of(beginning(options, 0.4)));
}

TEST(Simulate, DifferentSeedsGiveDifferentRuns) {
  for (const char* scene : {"S3", "wall", "aisle"}) {
    const SimulatedRun a = run(scene, 1), b = run(scene, 2);
    EXPECT_NE(bytes_of(a.events), bytes_of(b.events));
    EXPECT_NE(a.truth.scale_m_per_unit, b.truth.scale_m_per_unit);
    EXPECT_NE(a.truth.tags[0].p_W_X_m, b.truth.tags[0].p_W_X_m);
  }
}

TEST(Simulate, FramesOnOrOffLeaveEverythingElseAlone) {
  for (const char* scene : {"wall", "aisle"}) {
    Options options;
    options.scene = scene;
    std::vector<Event> with = beginning(options, 1.2);
    options.frames = false;
    std::vector<Event> without = beginning(options, 1.2);
    EXPECT_GT(std::erase_if(with, [](const Event& e) { return std::holds_alternative<Frame>(e); }), 30U);
    with.erase(with.begin());  // Start says where the poses come from
    without.erase(without.begin());
    EXPECT_EQ(bytes_of(with), bytes_of(without));
  }
}

TEST(Simulate, AnotherOdometryClassLeavesReadsAndTruthAlone) {
  SimulatedRun good = run("S3", 4, "PERFECT"), bad = run("S3", 4, "BAD");
  const auto no_poses = [](const Event& e) { return std::holds_alternative<CameraPose>(e); };
  std::erase_if(good.events, no_poses);
  std::erase_if(bad.events, no_poses);
  EXPECT_EQ(bytes_of(good.events), bytes_of(bad.events));
  EXPECT_EQ(good.truth.scale_m_per_unit, bad.truth.scale_m_per_unit);
}

TEST(Simulate, EventsStartWithStartAndComeInTimeOrder) {
  for (const std::string& scene : scene_names()) {
    const SimulatedRun r = run(scene, 1);
    ASSERT_TRUE(std::holds_alternative<Start>(r.events.front()));
    std::size_t ticks = 0, poses = 0;
    for (std::size_t i = 1; i < r.events.size(); ++i) {
      EXPECT_LE(time_of(r.events[i - 1]), time_of(r.events[i]));
      ticks += std::holds_alternative<Tick>(r.events[i]) ? 1 : 0;
      poses += std::holds_alternative<CameraPose>(r.events[i]) ? 1 : 0;
    }
    EXPECT_EQ(poses, r.truth.trajectory.size());
    EXPECT_GE(ticks, 7U) << scene;
  }
}

TEST(Simulate, WIsTheCartAtTheFirstFrame) {
  for (const char* scene : {"S3", "wall", "aisle", "purerotation"}) {
    const Truth truth = run(scene, 1).truth;
    const Rigid3 T_W_B = truth.trajectory.front().T_W_C * truth.calibration.T_B_C.inverse();
    EXPECT_LT(T_W_B.t.norm(), 1e-12) << scene;
    EXPECT_LT(T_W_B.R.angularDistance(Eigen::Quaterniond::Identity()), 1e-7) << scene;
  }
}

TEST(Simulate, PerfectPosesTimesScaleAreTheTruthInW) {
  const SimulatedRun r = run("aisle", 6, "PERFECT");
  std::size_t k = 0;
  for (const Event& event : r.events) {
    const CameraPose* pose = std::get_if<CameraPose>(&event);
    if (pose == nullptr) continue;
    const Rigid3& T_W_V = r.truth.trajectory[0].T_W_C;
    EXPECT_EQ(pose->time, r.truth.trajectory[k].time);
    EXPECT_LT((T_W_V * (r.truth.scale_m_per_unit * pose->T_V_C.p_V_C) - r.truth.trajectory[k].T_W_C.t).norm(), 1e-9);
    ++k;
  }
}

TEST(Simulate, JournalCarriesTheNominalLeverArmsNotTheTrueOnes) {
  const SimulatedRun r = run("S3", 1);
  const Calibration& nominal = std::get<Start>(r.events.front()).calibration;
  for (std::size_t a = 0; a < 2; ++a) {
    const double error_m = (nominal.antennas[a].p_C_A_m - r.truth.calibration.antennas[a].p_C_A_m).norm();
    EXPECT_GT(error_m, 0.0);
    EXPECT_LT(error_m, 5.0 * nominal.antennas[a].lever_arm_sigma_m.maxCoeff());
  }
}

TEST(Simulate, ReaderDelayMovesTheStampsOnly) {
  Options options;
  options.scene = "S3";
  options.frames = false;
  std::vector<TagRead> now, late;
  for (const Event& e : run(options).events) {
    if (const TagRead* read = std::get_if<TagRead>(&e)) now.push_back(*read);
  }
  options.reader_delay_s = 0.01;
  for (const Event& e : run(options).events) {
    if (const TagRead* read = std::get_if<TagRead>(&e)) late.push_back(*read);
  }
  ASSERT_EQ(now.size(), late.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_EQ((late[i].time - now[i].time).ns, 10'000'000);
    EXPECT_EQ(late[i].phase, now[i].phase);
  }
}

TEST(Simulate, MostTagsAreReadOnBothPorts) {
  for (const char* scene : {"S3", "S6", "wall", "aisle"}) {
    const SimulatedRun r = run(scene, 2);
    std::set<std::pair<Epc, int>> pairs;
    for (const Event& e : r.events) {
      if (const TagRead* read = std::get_if<TagRead>(&e)) pairs.emplace(read->epc, read->port);
    }
    EXPECT_GE(pairs.size(), r.truth.tags.size() * 2 * 9 / 10) << scene;
  }
}

TEST(Simulate, DegenerateScenesAreWhatTheirNamesSay) {
  for (const char* scene : {"purerotation", "standstill"}) {
    const Truth truth = run(scene, 1).truth;
    for (const TruePose& pose : truth.trajectory)
      EXPECT_LT((pose.T_W_C.t - truth.trajectory[0].T_W_C.t).norm(), 1e-9) << scene;
  }
  const Truth turning = run("purerotation", 1).truth;
  EXPECT_GT(turning.trajectory.front().T_W_C.R.angularDistance(turning.trajectory.back().T_W_C.R), 1.0);
  for (const TruePose& pose : run("straight", 1).truth.trajectory) {
    EXPECT_LT(pose.T_W_C.t.tail<2>().norm(), 1e-9);  // along x of W only
  }
  EXPECT_EQ(run("straight1ant", 1).truth.calibration.antennas.size(), 1U);
  EXPECT_EQ(run("onetag", 1).truth.tags.size(), 1U);
  EXPECT_EQ(run("tags300", 1).truth.tags.size(), 300U);
  std::size_t left = 0;
  for (const TrueTag& tag : run("stackedmirror", 1).truth.tags) left += tag.p_W_X_m.y() > 0 ? 1 : 0;
  EXPECT_EQ(left, 10U);
}

TEST(Simulate, UnknownSceneOrClassListsTheKnownOnes) {
  const Sink sink = [](const Event&) -> Status { return Done{}; };
  Options options;
  options.scene = "attic";
  EXPECT_NE(simulate(options, sink).error().text().find("S3"), std::string::npos);
  options.scene = "S3";
  options.vo_class = "SUPERB";
  EXPECT_NE(simulate(options, sink).error().text().find("NOMINAL"), std::string::npos);
}

}  // namespace
}  // namespace rfmvo::simulate
