#include <gtest/gtest.h>

#include <set>

#include "config/config_table.hpp"
#include "edges/toml_files.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

std::string config_error(const std::string& toml) {
  const auto config = parse_config(toml, "box.toml");
  return config.ok() ? "" : config.error().text();
}

std::string calibration_error(const std::string& toml) {
  const auto calibration = parse_calibration(toml, "cart.toml");
  return calibration.ok() ? "" : calibration.error().text();
}

const std::string kCamera = "[camera]\nwidth_px=8\nheight_px=6\nfx_px=10\nfy_px=10\ncx_px=4\ncy_px=3\n";

TEST(ConfigTable, EveryDefaultIsInItsOwnRange) {
  for (const ConfigRow& row : config_rows()) {
    Config config;
    EXPECT_TRUE(set_value(config, row.key, get_value(config, row)).ok()) << row.key;
    EXPECT_FALSE(row.doc.empty()) << row.key;
  }
}

TEST(ConfigTable, KeysAreUniqueAndGroupedBySection) {
  std::set<std::string_view> keys, closed;
  std::string_view section;
  for (const ConfigRow& row : config_rows()) {
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
    const std::string_view own = row.key.substr(0, row.key.find('.'));
    if (own != section) {
      EXPECT_TRUE(closed.insert(own).second) << own;
    }
    section = own;
  }
}

TEST(ConfigToml, WritingAndReadingGivesTheSameBits) {
  Config config;
  double x = 1.0 / 3.0;
  for (const ConfigRow& row : config_rows()) {
    if (!std::holds_alternative<ConfigRow::Real>(row.member)) continue;
    const double value = row.min + (row.max - row.min) * x;
    if (set_value(config, row.key, value).ok()) x = x * 0.9 + 0.01;
  }
  config.joint.scale_min_m = 0.1 + 0.2;
  config.joint.scale_max_m = 7;
  config.paper.fix_cycles = true;
  config.lcm.url = "file:///tmp/a \"quoted\" \\ path";
  const auto back = parse_config(to_toml(config), "journal");
  ASSERT_TRUE(back.ok()) << back.error().text();
  for (const ConfigRow& row : config_rows()) EXPECT_EQ(get_value(back.value(), row), get_value(config, row)) << row.key;
}

TEST(ConfigToml, KeysThatAreNotMentionedKeepTheBase) {
  Config base;
  base.joint.structured_sigma_rad = 0.5;
  const auto config = parse_config("[joint]\ntag_range_max_m = 3\n", "box.toml", base);
  ASSERT_TRUE(config.ok());
  EXPECT_EQ(config.value().joint.structured_sigma_rad, 0.5);
  EXPECT_EQ(config.value().joint.tag_range_max_m, 3.0);
}

TEST(ConfigToml, AnUnknownKeyNamesFileLineAndTheNearestKey) {
  EXPECT_EQ(config_error("[joint]\n\nstructured_sigma_deg = 3\n"),
            "box.toml:3: joint.structured_sigma_deg: unknown key; did you mean joint.structured_sigma_rad?");
  EXPECT_EQ(config_error("[estimater]\nkind = \"joint\"\n"),
            "box.toml:2: estimater.kind: unknown key; did you mean estimator.kind?");
  EXPECT_EQ(config_error("kind = 1\n").substr(0, 30), "box.toml:1: kind: unknown key;");
}

TEST(ConfigToml, AWrongTypeNamesKeyAndUnit) {
  EXPECT_EQ(config_error("[joint]\ntag_range_max_m = \"300 cm\"\n"),
            "box.toml:2: joint.tag_range_max_m: expects a number in m, not the text \"300 cm\"");
  EXPECT_EQ(config_error("[paper]\nelements = 60.5\n"),
            "box.toml:2: paper.elements: expects a whole number, not the number 60.5");
  EXPECT_EQ(config_error("[paper]\nfix_cycles = 1\n"),
            "box.toml:2: paper.fix_cycles: expects true or false, not the number 1");
  EXPECT_EQ(config_error("[joint]\ntag_range_max_m = [1, 2]\n"),
            "box.toml:2: joint.tag_range_max_m: expects one value, not a list, table or date");
}

TEST(ConfigToml, AValueOutOfRangeNamesTheRange) {
  EXPECT_EQ(config_error("[sync]\nmax_pose_gap_s = 200\n"),
            "box.toml:2: sync.max_pose_gap_s: 200 is outside 0.001 to 10 s");
  EXPECT_EQ(config_error("[estimator]\nkind = \"best\"\n"),
            "box.toml:2: estimator.kind: expects one of joint|paper, not the text \"best\"");
  EXPECT_EQ(config_error("[joint]\nscale_min_m = 5\nscale_max_m = 1\n"),
            "box.toml: joint.scale_min_m: must be below joint.scale_max_m");
}

TEST(ConfigToml, WhatIsNotTomlNamesFileAndLine) {
  EXPECT_EQ(config_error("[joint]\nknot_spacing_m 3\n").substr(0, 27), "box.toml:2: not valid TOML:");
}

TEST(ConfigToml, AMissingFileIsNamed) {
  const auto config = read_config("/nowhere/box.toml");
  ASSERT_FALSE(config.ok());
  EXPECT_EQ(config.error().text(), "/nowhere/box.toml: no such file");
}

TEST(ConfigTable, TextFromTheCommandLineIsReadByTheTypeOfItsRow) {
  Config config;
  EXPECT_TRUE(set_value_from_text(config, "paper.elements", "42").ok());
  EXPECT_TRUE(set_value_from_text(config, "joint.knot_spacing_m", "0.5").ok());
  EXPECT_TRUE(set_value_from_text(config, "paper.fix_cycles", "true").ok());
  EXPECT_TRUE(set_value_from_text(config, "lcm.prefix", "42").ok());
  EXPECT_EQ(config.paper.elements, 42);
  EXPECT_EQ(config.joint.knot_spacing_m, 0.5);
  EXPECT_TRUE(config.paper.fix_cycles);
  EXPECT_EQ(config.lcm.prefix, "42");
  EXPECT_EQ(set_value_from_text(config, "joint.knot_spacing_m", "5 cm").error().text(),
            "joint.knot_spacing_m: expects a number in m, not the text \"5 cm\"");
}

TEST(CalibrationToml, WritingAndReadingGivesTheSameBits) {
  const Calibration c = testing::sample_calibration();
  const auto back = parse_calibration(to_toml(c), "journal");
  ASSERT_TRUE(back.ok()) << back.error().text();
  const Calibration& b = back.value();
  EXPECT_EQ(b.camera.fx_px, c.camera.fx_px);
  EXPECT_EQ(b.camera.fy_px, c.camera.fy_px);
  EXPECT_EQ(b.camera.cy_px, c.camera.cy_px);
  EXPECT_EQ(b.camera.radtan, c.camera.radtan);
  EXPECT_EQ(b.T_B_C.R.coeffs(), c.T_B_C.R.coeffs());
  EXPECT_EQ(b.T_B_C.t, c.T_B_C.t);
  EXPECT_EQ(b.camera_sigma_m, c.camera_sigma_m);
  EXPECT_EQ(b.camera_rotation_sigma_rad, c.camera_rotation_sigma_rad);
  ASSERT_EQ(b.antennas.size(), c.antennas.size());
  for (std::size_t i = 0; i < c.antennas.size(); ++i) {
    EXPECT_EQ(b.antennas[i].port, c.antennas[i].port);
    EXPECT_EQ(b.antennas[i].p_C_A_m, c.antennas[i].p_C_A_m);
    EXPECT_EQ(b.antennas[i].boresight_C, c.antennas[i].boresight_C);
    EXPECT_EQ(b.antennas[i].lever_arm_sigma_m, c.antennas[i].lever_arm_sigma_m);
    EXPECT_EQ(b.antennas[i].electrical_length_m, c.antennas[i].electrical_length_m);
    EXPECT_EQ(b.antennas[i].electrical_length_sigma_m, c.antennas[i].electrical_length_sigma_m);
  }
}

TEST(CalibrationToml, UnknownKeysNameTheNearest) {
  EXPECT_EQ(calibration_error(kCamera + "focal_px = 3\n"),
            "cart.toml:8: camera.focal_px: unknown key; did you mean fx_px?");
  EXPECT_EQ(calibration_error(kCamera + "[mount]\n"), "cart.toml:8: mount: unknown key; did you mean mounting?");
  EXPECT_EQ(calibration_error(kCamera + "[[antenna]]\nport=1\np_C_A_mm=[1,2,3]\n"),
            "cart.toml:8: antenna.p_C_A_m: is missing");
  EXPECT_EQ(calibration_error(kCamera + "[[antenna]]\nport=1\np_C_A_m=[1,2,3]\nlever_arm_sigma_mm=5\n"),
            "cart.toml:11: antenna.lever_arm_sigma_mm: unknown key; did you mean lever_arm_sigma_m?");
}

TEST(CalibrationToml, ALeverArmsSigmaIsOneNumberOrOneForEachAxis) {
  const std::string antenna = kCamera + "[[antenna]]\nport=1\np_C_A_m=[0,0,0]\n";
  const auto sigma_of = [&](const std::string& line) {
    const auto calibration = parse_calibration(antenna + line, "cart.toml");
    EXPECT_TRUE(calibration.ok()) << calibration.error().text();
    return calibration.value().antennas.at(0).lever_arm_sigma_m;
  };
  EXPECT_EQ(sigma_of(""), Eigen::Vector3d::Constant(0.005));
  EXPECT_EQ(sigma_of("lever_arm_sigma_m = 0.02\n"), Eigen::Vector3d::Constant(0.02));
  EXPECT_EQ(sigma_of("lever_arm_sigma_m = [0.01, 0.005, 0]\n"), Eigen::Vector3d(0.01, 0.005, 0.0));
  EXPECT_EQ(calibration_error(antenna + "lever_arm_sigma_m = [0.01, 0.005]\n"),
            "cart.toml:11: antenna.lever_arm_sigma_m: expects a number or a list of three in m");
  EXPECT_EQ(calibration_error(antenna + "lever_arm_sigma_m = [0.01, 0.005, 50]\n"),
            "cart.toml:11: antenna.lever_arm_sigma_m: 50.0 is outside 0.0 to 10.0 m");
  EXPECT_EQ(calibration_error(antenna + "lever_arm_sigma_m = \"5 mm\"\n"),
            "cart.toml:11: antenna.lever_arm_sigma_m: expects a number or a list of three in m");
}

TEST(CalibrationToml, AnElectricalLengthIsUnknownUnlessStated) {
  const std::string antenna = kCamera + "[[antenna]]\nport=1\np_C_A_m=[0,0,0]\n";
  const auto silent = parse_calibration(antenna, "cart.toml");
  ASSERT_TRUE(silent.ok()) << silent.error().text();
  EXPECT_EQ(silent.value().antennas.at(0).electrical_length_m, 0.0);
  EXPECT_EQ(silent.value().antennas.at(0).electrical_length_sigma_m, AntennaCalibration::kElectricalLengthUnknown_m);
  const auto stated =
      parse_calibration(antenna + "electrical_length_m = 7.25\nelectrical_length_sigma_m = 0.1\n", "cart.toml");
  ASSERT_TRUE(stated.ok()) << stated.error().text();
  EXPECT_EQ(stated.value().antennas.at(0).electrical_length_m, 7.25);
  EXPECT_EQ(stated.value().antennas.at(0).electrical_length_sigma_m, 0.1);
  EXPECT_EQ(calibration_error(antenna + "electrical_length_m = 7250\n"),
            "cart.toml:11: antenna.electrical_length_m: 7250.0 is outside -200.0 to 200.0 m");
}

TEST(CalibrationToml, WrongValuesNameKeyAndUnit) {
  EXPECT_EQ(calibration_error(kCamera + "[[antenna]]\nport=1\np_C_A_m=[250,0,0]\n"),
            "cart.toml:10: antenna.p_C_A_m: 250.0 is outside -10.0 to 10.0 m");
  EXPECT_EQ(calibration_error(kCamera + "[[antenna]]\nport=1\np_C_A_m=[0.25,0]\n"),
            "cart.toml:10: antenna.p_C_A_m: expects a list of 3 numbers in m");
  EXPECT_EQ(calibration_error(kCamera + "[[antenna]]\nport=1\np_C_A_m=[0,0,0]\nboresight_C=[0,0,2]\n").substr(0, 31),
            "cart.toml:11: antenna.boresight");
  EXPECT_EQ(calibration_error(kCamera + "[[antenna]]\nport=1\np_C_A_m=[0,0,0]\n[[antenna]]\nport=1\np_C_A_m=[0,0,0]\n"),
            "cart.toml:11: antenna.port: 1 is there twice");
  EXPECT_EQ(calibration_error("[camera]\nmodel=\"fisheye\"\n").substr(0, 12), "cart.toml:1:");
  EXPECT_EQ(calibration_error(""), "cart.toml: camera: is missing");
}

TEST(CalibrationToml, AHandWrittenQuaternionIsNormalised) {
  const auto c = parse_calibration(kCamera + "[mounting]\nquaternion_wxyz=[0.7071, 0.0, 0.7071, 0]\n", "cart.toml");
  ASSERT_TRUE(c.ok()) << c.error().text();
  EXPECT_NEAR(c.value().T_B_C.R.norm(), 1.0, 1e-15);
}

}  // namespace
}  // namespace rfmvo
