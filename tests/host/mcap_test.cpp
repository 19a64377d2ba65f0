// Exported MCAP files, read by the official Python library: its reader checks magic, lengths, CRCs and the summary.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "edges/journal.hpp"
#include "host/host_command.hpp"
#include "mcap/export_mcap.hpp"
#include "mcap/mcap_writer.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo {
namespace {

using testing::expect_one_line;
using testing::in_quotes;
using testing::TemporaryFolder;
using Json = nlohmann::json;

// Everything in the file, once through the summary and once from front to end; both must agree.
constexpr const char* kRead = R"(import json, sys
from mcap.reader import SeekingReader, NonSeekingReader
with open(sys.argv[1], 'rb') as f:
    reader = SeekingReader(f, validate_crcs=True)
    summary = reader.get_summary()
    messages = [(s.name, c.topic, m.log_time, json.loads(m.data)) for s, c, m in reader.iter_messages()]
with open(sys.argv[1], 'rb') as f:
    front = [(s.name, c.topic, m.log_time, json.loads(m.data))
             for s, c, m in NonSeekingReader(f, validate_crcs=True).iter_messages()]
assert sorted(map(str, front)) == sorted(map(str, messages))
for schema in summary.schemas.values():
    assert schema.encoding == 'jsonschema' and json.loads(schema.data)['title'] == schema.name
statistics = summary.statistics
assert statistics.message_count == len(messages)
assert statistics.chunk_count == len(summary.chunk_indexes)
times = [m[2] for m in messages]
assert times == sorted(times)
assert not times or (statistics.message_start_time, statistics.message_end_time) == (times[0], times[-1])
for id, channel in summary.channels.items():
    assert statistics.channel_message_counts.get(id, 0) == sum(m[1] == channel.topic for m in messages)
print(json.dumps({'chunks': statistics.chunk_count, 'messages': messages}))
)";

class Mcap : public ::testing::Test {
 protected:
  void SetUp() override {
    if (testing::run_command("'" + python_ + "' -c 'import mcap'").exit_code != 0)
      GTEST_SKIP() << "no Python mcap in " << RFMVO_VENV << " (cmake/install-packages.sh puts it there)";
    testing::write_file(folder_ / "read.py", kRead);
  }
  Json read(const std::string& file) {
    const auto result =
        testing::run_command("'" + python_ + "' " + in_quotes(folder_ / "read.py") + " " + in_quotes(file));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json{};
  }
  void write_result(const std::string& name, const std::vector<Estimate>& result) {
    auto writer = LogWriter::create(folder_ / name, "RFMVO_");
    ASSERT_TRUE(writer.ok());
    for (const Estimate& estimate : result) ASSERT_TRUE(writer.value()->publish(estimate).ok());
    ASSERT_TRUE(writer.value()->close().ok());
  }
  TemporaryFolder folder_;
  std::string python_ = std::string(RFMVO_VENV) + "/bin/python3";
  std::string mcap_ = folder_ / "out.mcap";
};

TEST_F(Mcap, ManyChunksHoldWhatWasWritten) {
  auto writer = mcap::McapWriter::create(mcap_);
  ASSERT_TRUE(writer.ok());
  const auto a = writer.value()->add_channel("/a", "T", R"({"title":"T"})");
  const auto b = writer.value()->add_channel("/b", "T", R"({"title":"T"})");
  const std::string padding(100'000, 'x');
  constexpr int kMessages = 200;  // 20 MB
  for (int k = 0; k < kMessages; ++k) {
    const Json json{{"k", k}, {"padding", padding}};
    // Times go back and forth.
    ASSERT_TRUE(writer.value()->write(k % 3 == 0 ? a : b, 1'000 + (k * 7919) % kMessages, json.dump()).ok());
  }
  ASSERT_TRUE(writer.value()->close().ok());
  const Json all = read(mcap_);
  EXPECT_GT(all.at("chunks").get<int>(), 3);
  ASSERT_EQ(all.at("messages").size(), static_cast<std::size_t>(kMessages));
  for (const Json& message : all.at("messages")) {
    const int k = message[3].at("k");
    EXPECT_EQ(message[1], k % 3 == 0 ? "/a" : "/b");
    EXPECT_EQ(message[2], 1'000 + (k * 7919) % kMessages);
    EXPECT_EQ(message[3].at("padding"), padding);
  }
}

TEST_F(Mcap, NothingIsWrittenIfNothingIsClosed) {
  { ASSERT_TRUE(mcap::McapWriter::create(mcap_).ok()); }
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"read.py"});
}

TEST_F(Mcap, EllipsoidsAreThoseOfTheCovariances) {
  const auto truth = testing::winding_truth(50, 3);
  auto result = testing::perfect_result(truth);
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, -0.005, 0.01, 0.02, 0.003, -0.005, 0.003, 0.01;
  for (Estimate& estimate : result)
    if (auto* tag = std::get_if<TagEstimate>(&estimate)) tag->covariance_m2 = covariance;
  write_result("result.lcmlog", result);
  ASSERT_TRUE(mcap::export_mcap({folder_ / "result.lcmlog"}, "RFMVO_", mcap_).ok());
  std::size_t tags = 0;
  const Json all = read(mcap_);
  for (const Json& message : all.at("messages")) {
    if (message[1].get<std::string>() != "/tags") continue;
    EXPECT_EQ(message[0], "foxglove.SceneUpdate");
    const Json& entity = message[3].at("entities").at(0);
    const Json& sphere = entity.at("spheres").at(0);
    const Json &p = sphere.at("pose").at("position"), &q = sphere.at("pose").at("orientation"), &d = sphere.at("size");
    const Eigen::Quaterniond R(q.at("w").get<double>(), q.at("x").get<double>(), q.at("y").get<double>(),
                               q.at("z").get<double>());
    const Eigen::Vector3d half =
        0.5 * Eigen::Vector3d(d.at("x").get<double>(), d.at("y").get<double>(), d.at("z").get<double>());
    // Points of the surface have the Mahalanobis distance of 95 % of chi-square with 3 degrees of freedom: 7.815.
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d surface = R * Eigen::Vector3d(half[axis] * Eigen::Vector3d::Unit(axis));
      EXPECT_NEAR(surface.dot(covariance.inverse() * surface), 7.815, 0.001);
    }
    const auto tag = std::find_if(truth.tags.begin(), truth.tags.end(),
                                  [&](const auto& t) { return t.epc.hex() == entity.at("id"); });
    ASSERT_NE(tag, truth.tags.end());
    EXPECT_NEAR(p.at("x").get<double>(), tag->p_W_X_m.x(), 1e-9);
    ++tags;
  }
  EXPECT_EQ(tags, truth.tags.size());
}

TEST_F(Mcap, PicturesPosesAndFaultsAreThere) {
  testing::write_journal(folder_ / "run.lcmlog", testing::one_of_each_event());
  write_result("result.lcmlog", testing::one_of_each_estimate());
  const auto exported = testing::rfmvo("export " + in_quotes(folder_ / "result.lcmlog") + " --frames " +
                                       in_quotes(folder_ / "run.lcmlog") + " --mcap " + in_quotes(mcap_));
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  std::map<std::string, Json> by_topic;
  const Json all = read(mcap_);
  for (const Json& message : all.at("messages")) by_topic[message[1].get<std::string>()] = message;
  EXPECT_EQ(by_topic.at("/camera/image")[0], "foxglove.CompressedImage");
  EXPECT_EQ(by_topic.at("/camera/image")[3].at("data").get<std::string>().substr(0, 8), "iVBORw0K") << "a PNG, base64";
  EXPECT_EQ(by_topic.at("/camera/calibration")[3].at("width"), 640);
  EXPECT_EQ(by_topic.at("/tf")[3].at("child_frame_id"), "camera");
  EXPECT_EQ(by_topic.at("/path")[3].at("entities")[0].at("lines")[0].at("points").size(), 2u);
  EXPECT_EQ(by_topic.at("/tags")[3].at("entities")[0].at("spheres").size(), 2u) << "both hypotheses";
  EXPECT_EQ(by_topic.count("/log"), 1u);
}

TEST(ExportTags, JsonHasEveryTagWhereTheResultHasIt) {
  const TemporaryFolder folder;
  const auto truth = testing::winding_truth(20, 4);
  {
    auto writer = LogWriter::create(folder / "r.lcmlog", "RFMVO_");
    ASSERT_TRUE(writer.ok());
    for (const Estimate& estimate : testing::perfect_result(truth)) ASSERT_TRUE(writer.value()->publish(estimate).ok());
    ASSERT_TRUE(writer.value()->close().ok());
  }
  const auto exported = testing::rfmvo("export " + in_quotes(folder / "r.lcmlog") + " --tags-json /dev/stdout");
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const Json json = Json::parse(exported.out);
  EXPECT_EQ(json.at("type"), "FeatureCollection");
  ASSERT_EQ(json.at("features").size(), truth.tags.size());
  for (std::size_t i = 0; i < truth.tags.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(json.at("features")[i].at("geometry").at("coordinates")[axis].get<double>(),
                  truth.tags[i].p_W_X_m[static_cast<Eigen::Index>(axis)], 1e-9);
}

TEST(ExportMcap, BadInputIsOneLine) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "tick.lcmlog", {Tick{}});
  const std::string tick = in_quotes(folder / "tick.lcmlog");
  expect_one_line(testing::rfmvo("export " + tick), "--mcap is required", 2);
  expect_one_line(testing::rfmvo("export " + tick + " --mcap " + in_quotes(folder / "x.mcap")),
                  "holds nothing that can be shown");
  expect_one_line(testing::rfmvo("export " + tick + " --mcap /nowhere/x.mcap"), "/nowhere/x.mcap: cannot be written");
  expect_one_line(testing::rfmvo("export " + tick + " --frames x --tum y"), "--mcap", 2);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"tick.lcmlog"});
}

}  // namespace
}  // namespace rfmvo
