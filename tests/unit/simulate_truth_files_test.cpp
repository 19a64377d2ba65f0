#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "simulate/simulation.hpp"

namespace rfmvo::simulate {
namespace {

namespace fs = std::filesystem;

class TruthFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = (fs::path(testing::TempDir()) /
                  ("rfmvo_truth_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name())))
                     .string();
    fs::remove_all(directory_);
    Options options;
    options.scene = "wall";
    options.frames = false;
    truth_ = simulate(options, [](const Event&) -> Status { return Done{}; }).value();
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string directory_;
  Truth truth_;
};

TEST_F(TruthFilesTest, WhatIsWrittenIsReadBack) {
  ASSERT_TRUE(write_truth(truth_, directory_).ok());
  const Result<Truth> read = read_truth(directory_);
  ASSERT_TRUE(read.ok()) << read.error().text();
  const Truth& back = read.value();
  ASSERT_EQ(back.tags.size(), truth_.tags.size());
  for (std::size_t i = 0; i < back.tags.size(); ++i) {
    EXPECT_EQ(back.tags[i].epc, truth_.tags[i].epc);
    EXPECT_LT((back.tags[i].p_W_X_m - truth_.tags[i].p_W_X_m).norm(), 1e-9);
  }
  ASSERT_EQ(back.trajectory.size(), truth_.trajectory.size());
  for (std::size_t i = 0; i < back.trajectory.size(); ++i) {
    EXPECT_EQ(back.trajectory[i].time, truth_.trajectory[i].time);
    EXPECT_LT((back.trajectory[i].T_W_C.t - truth_.trajectory[i].T_W_C.t).norm(), 1e-9);
    EXPECT_LT(back.trajectory[i].T_W_C.R.angularDistance(truth_.trajectory[i].T_W_C.R), 1e-7);
  }
  ASSERT_EQ(back.calibration.antennas.size(), 2U);
  EXPECT_LT((back.calibration.antennas[1].p_C_A_m - truth_.calibration.antennas[1].p_C_A_m).norm(), 1e-12);
  EXPECT_NEAR(back.scale_m_per_unit, truth_.scale_m_per_unit, 1e-10);
}

TEST_F(TruthFilesTest, NoTemporaryFilesStay) {
  ASSERT_TRUE(write_truth(truth_, directory_).ok());
  for (const auto& entry : fs::directory_iterator(directory_)) EXPECT_NE(entry.path().extension(), ".tmp");
}

TEST_F(TruthFilesTest, AMissingFileIsNamed) {
  ASSERT_TRUE(write_truth(truth_, directory_).ok());
  fs::remove(fs::path(directory_) / "scale.csv");
  EXPECT_NE(read_truth(directory_).error().text().find("scale.csv"), std::string::npos);
}

TEST_F(TruthFilesTest, AMalformedLineIsNamed) {
  ASSERT_TRUE(write_truth(truth_, directory_).ok());
  std::ofstream(fs::path(directory_) / "tags.csv") << "epc,x_m,y_m,z_m\nE200,1,2\n";
  EXPECT_NE(read_truth(directory_).error().text().find("tags.csv:2"), std::string::npos);
}

TEST_F(TruthFilesTest, AnUnwritableFolderIsNamed) {
  const std::string file = directory_ + "_file";
  std::ofstream(file) << "x";
  const Status status = write_truth(truth_, file + "/below");
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().text().find(file), std::string::npos);
  fs::remove(file);
}

}  // namespace
}  // namespace rfmvo::simulate
