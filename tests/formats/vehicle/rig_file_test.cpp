#include "rayfield/formats/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;

constexpr const char* kWhole = R"([lidar]
topic = "/lidar/scan"
min_range_m = 0.3
max_range_m = 35
no_return = "zero"
[spinner]
topic = "/joints"
joint = "table"
axis = [0, 0, 1]
[imu]
topic = "/imu"
gyro_noise_rad_s_sqrt_hz = 1e-3
[gps]
topic = "/fix"
[extrinsics]
imu_from_spinner = { xyz = [0.06, 0.0, 0.11], q = [0, 0, 0, 1] }
spinner_from_lidar = { xyz = [0.035, 0, 0.02], q = [0.7071068, 0, 0, 0.7071068] }
imu_from_gps = { xyz = [-0.42, 0.11, 0.55] }
[time]
lidar_offset_s = 0.02
gps_offset_s = -0.1
estimate_lidar_offset = true
)";

std::string error_line(const std::string& text) {
  const auto rig = parse_rig(text, "rig.toml");
  if (rig) ADD_FAILURE() << "accepted: " << text;
  if (rig) return {};
  EXPECT_EQ(rig.error().code, ErrorCode::usage);
  return rig.error().line();
}

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kWhole;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(RigFile, ReadsEveryKey) {
  const auto rig = parse_rig(kWhole, "rig.toml");
  ASSERT_TRUE(rig) << rig.error().line();
  EXPECT_EQ(rig->lidar.topic, "/lidar/scan");
  EXPECT_EQ(rig->lidar.min_range_m, 0.3);
  EXPECT_EQ(rig->lidar.max_range_m, 35.0);
  EXPECT_EQ(rig->lidar.no_return, NoReturn::zero);
  EXPECT_EQ(rig->spinner->topic, "/joints");
  EXPECT_EQ(rig->spinner->joint, "table");
  EXPECT_EQ(rig->imu.gyro_noise_rad_s_sqrt_hz, 1e-3);
  EXPECT_EQ(rig->imu.accel_noise_m_s2_sqrt_hz, Rig::Imu().accel_noise_m_s2_sqrt_hz);
  EXPECT_EQ(rig->gps->topic, "/fix");
  EXPECT_EQ(rig->imu_from_spinner.translation, Eigen::Vector3d(0.06, 0, 0.11));
  // 90° about x: the lidar's y is the spinner's z.
  const Eigen::Vector3d y_in_spinner = rig->spinner_from_lidar.rotation * Eigen::Vector3d::UnitY();
  EXPECT_LT((y_in_spinner - Eigen::Vector3d::UnitZ()).norm(), 1e-7);
  EXPECT_NEAR(rig->spinner_from_lidar.rotation.norm(), 1.0, 1e-15);
  EXPECT_EQ(rig->imu_from_gps_m, Eigen::Vector3d(-0.42, 0.11, 0.55));
  EXPECT_EQ(rig->lidar_offset_s, 0.02);
  EXPECT_EQ(rig->gps_offset_s, -0.1);
  EXPECT_TRUE(rig->estimate_lidar_offset);
  EXPECT_FALSE(rig->estimate_gps_offset);
}

TEST(RigFile, RoundTripsThroughItsOwnText) {
  const auto rig = parse_rig(kWhole, "rig.toml");
  const auto again = parse_rig(rig_text(*rig), "again");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(rig_text(*again), rig_text(*rig));
  EXPECT_LT((again->spinner_from_lidar.rotation.coeffs() - rig->spinner_from_lidar.rotation.coeffs()).norm(), 1e-15);
  const bytes::TemporaryFile file("", ".toml");
  ASSERT_TRUE(write_rig(file.path(), *rig));
  const auto from_file = read_rig(file.path());
  ASSERT_TRUE(from_file) << from_file.error().line();
  EXPECT_EQ(rig_text(*from_file), rig_text(*rig));
}

TEST(RigFile, ReadsTheBeamAndWritesItBack) {
  EXPECT_FALSE(parse_rig(kWhole, "rig.toml")->lidar.beam);
  const std::string stated = replaced("[spinner]", "beam_diameter_m = 0.0136\nbeam_divergence_rad = 0.0119\n[spinner]");
  const auto rig = parse_rig(stated, "rig.toml");
  ASSERT_TRUE(rig) << rig.error().line();
  EXPECT_EQ(rig->lidar.beam, (LidarBeam{0.0136, 0.0119, {}}));
  EXPECT_EQ(parse_rig(rig_text(*rig), "again")->lidar.beam, rig->lidar.beam);
  const auto full = parse_rig(
      replaced("[spinner]", "model = \"SICK LMS111\"\ndetection_share = 0.3\nrange_resolution_m = 0.2\n[spinner]"),
      "r");
  ASSERT_TRUE(full) << full.error().line();
  EXPECT_EQ(full->lidar.beam, (LidarBeam{0.008, 0.015, 0.3, 0.2}));
  EXPECT_EQ(parse_rig(rig_text(*full), "again")->lidar.beam, full->lidar.beam);
  // What is stated rules over the data sheet.
  const auto high =
      parse_rig(replaced("[spinner]", "model = \"LMS511\"\nbeam_divergence_rad = 0.0047\n[spinner]"), "r");
  ASSERT_TRUE(high) << high.error().line();
  EXPECT_EQ(high->lidar.beam, (LidarBeam{0.0136, 0.0047, {}}));
}

TEST(RigFile, ABeamMayBeEllipticalOrALine) {
  const auto beam_with = [](const std::string& keys) {
    const auto rig = parse_rig(replaced("[spinner]", keys + "\n[spinner]"), "r");
    EXPECT_TRUE(rig) << rig.error().line();
    EXPECT_EQ(parse_rig(rig_text(*rig), "again")->lidar.beam, rig->lidar.beam);
    return rig->lidar.beam.value();
  };
  // A disc of the ellipse's area: π/4·θ₁·θ₂ = π/4·θ².
  EXPECT_DOUBLE_EQ(beam_with("beam_diameter_m = 0.01\nbeam_divergence_rad = [0.002, 0.008]").divergence_rad, 0.004);
  EXPECT_EQ(beam_with("beam_divergence_rad = 0").diameter_at(2), 0);
  EXPECT_EQ(beam_with("beam_divergence_rad = 0.0").diameter_at(30), 0);
}

TEST(RigFile, KnowsWhichEchoALidarReports) {
  const auto beam_with = [](const std::string& keys) {
    const auto rig = parse_rig(replaced("[spinner]", keys + "\n[spinner]"), "r");
    EXPECT_TRUE(rig) << rig.error().line();
    EXPECT_EQ(parse_rig(rig_text(*rig), "again")->lidar.beam, rig->lidar.beam);
    return *rig->lidar.beam;
  };
  EXPECT_EQ(beam_with("model = \"LMS511\"").returns, std::nullopt);
  EXPECT_EQ(beam_with("model = \"LMS511\"\nreturns = \"last\"").returns, ReturnMode::last);
  EXPECT_EQ(beam_with("model = \"VLP-16\"").returns, ReturnMode::strongest);  // its usual setting
  EXPECT_EQ(beam_with("model = \"OS1\"\nreturns = \"first\"").returns, ReturnMode::first);
}

TEST(RigFile, RefusesBeamsThatAreNotOne) {
  const auto with = [](const std::string& keys) { return error_line(replaced("[spinner]", keys + "\n[spinner]")); };
  EXPECT_THAT(with("beam_diameter_m = 13.6\nbeam_divergence_rad = 0.01"), HasSubstr("must be 0 to 0.2"));
  EXPECT_THAT(with("beam_diameter_m = 0.01\nbeam_divergence_rad = 11.9"), HasSubstr("must be 0 to 0.1"));
  EXPECT_THAT(with("beam_diameter_m = 0.01"), HasSubstr("lidar.beam_divergence_rad is missing"));
  EXPECT_THAT(with("beam_diameter_m = 0.01\nbeam_divergence_rad = [0.01, 0.02, 0.03]"),
              HasSubstr("lidar.beam_divergence_rad: must be an array of 2 numbers"));
  EXPECT_THAT(with("beam_diameter_m = 0.01\nbeam_divergence_rad = [0.01, 0]"), HasSubstr("both must be above 0"));
  EXPECT_THAT(with("beam_diameter_m = 0.01\nbeam_divergence_rad = [2, 8]"), HasSubstr("up to 0.1"));
  EXPECT_THAT(with("beam_divergence_rad = [0.01, 0.02]"), HasSubstr("lidar.beam_diameter_m is missing"));
  EXPECT_THAT(with("beam_divergence_rad = 0.01"), HasSubstr("lidar.beam_diameter_m is missing"));
  EXPECT_THAT(with("detection_share = 0.25"), HasSubstr("lidar.detection_share: it needs beam_diameter_m"));
  EXPECT_THAT(with("model = \"LMS511\"\ndetection_share = 1.5"), HasSubstr("must be 0.001 to 1"));
  EXPECT_THAT(with("range_resolution_m = 0.2"), HasSubstr("lidar.range_resolution_m: it needs beam_diameter_m"));
  EXPECT_THAT(with("model = \"LMS511\"\nrange_resolution_m = 20"), HasSubstr("must be 0.005 to 2"));
  EXPECT_THAT(with("returns = \"first\""), HasSubstr("lidar.returns: it needs beam_diameter_m"));
  EXPECT_THAT(with("model = \"LMS511\"\nreturns = \"all\""), HasSubstr("must be \"first\", \"strongest\" or \"last\""));
  EXPECT_THAT(with("model = \"LMS511\"\nreturns = 1"), HasSubstr("must be \"first\", \"strongest\" or \"last\""));
  EXPECT_THAT(with("model = \"LMS999\""), HasSubstr("not a lidar whose beam is known (LMS511"));
}

// A ray cloud needs the beam alone: no mounting.
TEST(RigFile, TheBeamIsReadFromAFileThatSaysNothingElse) {
  const bytes::TemporaryFile alone("[lidar]\nmodel = \"VLP-16\"\n", ".toml"), none("[lidar]\n", ".toml"),
      bad("[lidar]\nbeam = 3\n", ".toml");
  EXPECT_EQ(*read_rig_beam(alone.path()),
            *parse_rig(replaced("[spinner]", "model = \"VLP16\"\n[spinner]"), "r")->lidar.beam);
  ASSERT_TRUE(read_rig_beam(none.path()));
  EXPECT_FALSE(*read_rig_beam(none.path()));
  EXPECT_THAT(read_rig_beam(bad.path()).error().line(), HasSubstr("lidar.beam: unknown key"));
}

TEST(RigFile, KeepsNamesWithQuotesAndBackslashes) {
  Rig rig;
  rig.lidar.topic = "/a\"b\\c\n";
  const auto again = parse_rig(rig_text(rig), "again");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->lidar.topic, rig.lidar.topic);
}

TEST(RigFile, ReadsAFixedLidarWithoutSpinnerAndGps) {
  const auto direct = parse_rig(
      "[lidar]\n[imu]\n[extrinsics]\nimu_from_lidar = { xyz = [1, 2, 3], q = [0, 0, 0.7071068, 0.7071068] }\n", "r");
  ASSERT_TRUE(direct) << direct.error().line();
  EXPECT_FALSE(direct->spinner);
  EXPECT_FALSE(direct->gps);
  EXPECT_EQ(direct->imu_from_spinner.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(direct->spinner_from_lidar.translation, Eigen::Vector3d(1, 2, 3));
  // The same mounting in two parts: 90° about z at (1, 2, 3), then nothing.
  const auto parts = parse_rig(
      "[extrinsics]\nimu_from_spinner = { xyz = [1, 2, 2], q = [0, 0, 0.7071068, 0.7071068] }\n"
      "spinner_from_lidar = { xyz = [0, 0, 1] }\n",
      "r");
  ASSERT_TRUE(parts) << parts.error().line();
  const Eigen::Vector3d p(0.5, 0.25, -1);
  EXPECT_LT((parts->spinner_from_lidar * p - direct->spinner_from_lidar * p).norm(), 1e-12);
}

TEST(RigFile, RefusesUnknownKeysWithTheirLine) {
  EXPECT_THAT(error_line(replaced("min_range_m", "min_range")),
              HasSubstr("rig.toml, line 3: lidar.min_range: unknown key"));
  EXPECT_THAT(error_line(std::string(kWhole) + "[camera]\n"), HasSubstr("camera: unknown key"));
  EXPECT_THAT(error_line(replaced("xyz = [-0.42, 0.11, 0.55]", "xyz = [0, 0, 0], q = [0, 0, 0, 1]")),
              HasSubstr("line 18: extrinsics.imu_from_gps.q: unknown key"));
}

TEST(RigFile, RefusesQuaternionsAndAxesThatAreNotUnit) {
  EXPECT_THAT(error_line(replaced("q = [0, 0, 0, 1]", "q = [0, 0, 0, 1.002]")),
              HasSubstr("line 16: extrinsics.imu_from_spinner.q: must be a unit quaternion"));
  EXPECT_THAT(error_line(replaced("q = [0, 0, 0, 1]", "q = [0, 0, 0, 0]")), HasSubstr("unit quaternion"));
  EXPECT_TRUE(parse_rig(replaced("q = [0, 0, 0, 1]", "q = [0, 0, 0, 1.0009]"), "r"));
  EXPECT_THAT(error_line(replaced("axis = [0, 0, 1]", "axis = [0, 1, 1]")), HasSubstr("line 9: spinner.axis"));
}

TEST(RigFile, RefusesValuesOfTheWrongKindOrRange) {
  EXPECT_THAT(error_line(replaced("= 0.3", "= \"0.3\"")), HasSubstr("line 3: lidar.min_range_m: must be a number"));
  EXPECT_THAT(error_line(replaced("= 0.3", "= -1")), HasSubstr("must be 0 to 1000"));
  EXPECT_THAT(error_line(replaced("= 0.3", "= nan")), HasSubstr("must be 0 to 1000"));
  EXPECT_THAT(error_line(replaced("= 0.3", "= 36")), HasSubstr("below max_range_m"));
  EXPECT_THAT(error_line(replaced("\"zero\"", "\"none\"")), HasSubstr("must be \"inf\", \"zero\" or \"max\""));
  EXPECT_THAT(error_line(replaced("\"/imu\"", "5")), HasSubstr("imu.topic: must be a string"));
  EXPECT_THAT(error_line(replaced("\"/imu\"", "\"\"")), HasSubstr("must not be empty"));
  EXPECT_THAT(error_line(replaced("\"/imu\"", "\"/fix\"")), HasSubstr("two sensors have the same topic"));
  EXPECT_THAT(error_line(replaced("= true", "= 1")), HasSubstr("must be true or false"));
  EXPECT_THAT(error_line(replaced("0.06, 0.0, 0.11", "0.06, 0.0")), HasSubstr("must be an array of 3 numbers"));
  EXPECT_THAT(error_line(replaced("0.06, 0.0, 0.11", "0.06, 0.0, 600")), HasSubstr("within 100 m"));
  EXPECT_THAT(error_line(replaced("0.02\n", "20\n")), HasSubstr("time.lidar_offset_s: must be -10 to 10"));
  EXPECT_THAT(error_line(replaced("{ xyz = [-0.42, 0.11, 0.55] }", "[1, 2, 3]")), HasSubstr("must be a table"));
  EXPECT_THAT(error_line("lidar = 5\n"), HasSubstr("line 1: lidar: must be a table"));
  EXPECT_THAT(error_line("[lidar\n"), HasSubstr("rig.toml, line 1"));
  EXPECT_THAT(error_line(std::string("[lidar]\n[\0\x05", 11)), HasSubstr("rig.toml, line 2: a control character"));
}

TEST(RigFile, AssumesNothingAboutTheMounting) {
  EXPECT_THAT(error_line(""), HasSubstr("extrinsics.imu_from_lidar is missing"));
  EXPECT_THAT(error_line("[spinner]\n[extrinsics]\n"), HasSubstr("extrinsics.imu_from_spinner is missing"));
  EXPECT_THAT(error_line(replaced("imu_from_gps = { xyz = [-0.42, 0.11, 0.55] }\n", "")),
              HasSubstr("extrinsics.imu_from_gps is missing"));
  EXPECT_THAT(error_line(replaced("spinner_from_lidar", "imu_from_lidar")), HasSubstr("the rig has a spinner"));
}

TEST(RigFile, GivesTheMountingAloneToPointsWithATrajectory) {
  const auto read = [](const std::string& text) {
    const bytes::TemporaryFile file(text, ".toml");
    return read_rig_mounting(file.path());
  };
  // Of the lidar on a spinner the centre of its circle: a quarter turn of the spinner frame, its axis along y.
  const auto spun = read(
      "[lidar]\nnonsense = 1\n[spinner]\naxis = [0, 1, 0]\n[extrinsics]\n"
      "imu_from_spinner = { xyz = [1, 2, 3], q = [0, 0, 0.7071067811865476, 0.7071067811865476] }\n"
      "spinner_from_lidar = { xyz = [0.5, 0.25, 0.125] }\n[time]\nlidar_offset_s = 0.02\n");
  ASSERT_TRUE(spun) << spun.error().line();
  EXPECT_LT((*spun->lidar_in_imu_m - Eigen::Vector3d(0.75, 2, 3)).norm(), 1e-12);
  EXPECT_EQ(spun->lidar_offset_s, 0.02);
  const auto fixed = read("[extrinsics]\nimu_from_lidar = { xyz = [0.1, 0, -0.2] }\n");
  ASSERT_TRUE(fixed) << fixed.error().line();
  EXPECT_LT((*fixed->lidar_in_imu_m - Eigen::Vector3d(0.1, 0, -0.2)).norm(), 1e-12);
  const auto beam = read("[lidar]\nmodel = \"VLP16\"\n");
  ASSERT_TRUE(beam) << beam.error().line();
  EXPECT_FALSE(beam->lidar_in_imu_m);
  EXPECT_THAT(read("[extrinsics]\n").error().line(), HasSubstr("extrinsics.imu_from_lidar is missing"));
  EXPECT_THAT(read("[extrinsics]\nimu_from_lidar = 5\n").error().line(), HasSubstr("line 2"));
}

TEST(RigFile, RefusesFilesThatCannotBeRead) {
  EXPECT_EQ(read_rig("/nonexistent/rig.toml").error().code, ErrorCode::bad_input);
  const bytes::TemporaryFile huge(std::string((1 << 20) + 1, '#'), ".toml");
  EXPECT_EQ(read_rig(huge.path()).error().code, ErrorCode::bad_input);
  Rig rig;
  rig.lidar.min_range_m = 100;
  EXPECT_EQ(write_rig(huge.path(), rig).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::formats
