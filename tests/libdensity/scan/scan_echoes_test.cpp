#include "libdensity/scan/scan_echoes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "libdensity/scan/scan_range_resolution.h"

namespace rayfield::density {
namespace {

tile::ScanEntry scan_with(double diameter_m, double divergence_rad) {
  tile::ScanEntry scan;
  scan.scan_id = "2020-01-20";
  scan.beam = LidarBeam{diameter_m, divergence_rad, {}};
  return scan;
}

TEST(ScanEchoes, UnknownAndThinBeamsAddNoErrorAndHaveNoView) {
  const IntegrationOptions options;
  EXPECT_EQ(integration_with_beam(options, tile::ScanEntry{}, {}).shared_error, options.shared_error);
  EXPECT_EQ(integration_with_beam(options, scan_with(0, 0), {}).shared_error, options.shared_error);
  EXPECT_EQ(beam_note(tile::ScanEntry{}, {}), "");
  EXPECT_EQ(beam_note(scan_with(0, 0.001), {}), "");
  EXPECT_TRUE(has_thin_beam(tile::ScanEntry{}) && has_thin_beam(scan_with(0, 0.001)));
  EXPECT_FALSE(has_thin_beam(scan_with(0.0136, 0.0119)));
  EXPECT_EQ(view_of(tile::ScanEntry{}, {}, {}), nullptr);
  EXPECT_EQ(view_of(scan_with(0, 0.001), {}, {}), nullptr);
}

TEST(ScanEchoes, WhetherThereAreLeavesIsAsDeclaredOrByTheMonth) {
  tile::ScanEntry scan;
  scan.date = "2020-01-20";
  EXPECT_EQ(foliage_of(scan, "EPSG:7854"), Foliage::unknown);                                         // nowhere
  scan.origin_bounds = {Eigen::Vector3d(276100, 6099900, 80), Eigen::Vector3d(276200, 6100000, 90)};  // 35° S
  EXPECT_EQ(foliage_of(scan, "EPSG:7854"), Foliage::likely);
  scan.dormant = true;
  EXPECT_EQ(foliage_of(scan, "EPSG:7854"), Foliage::none);
  scan.date = "2020-07-20", scan.dormant = false;
  EXPECT_EQ(foliage_of(scan, "EPSG:7854"), Foliage::likely);
  scan.dormant = std::nullopt;
  EXPECT_EQ(foliage_of(scan, "EPSG:7854"), Foliage::unlikely);
  scan.date = "2020-10-20";
  EXPECT_EQ(foliage_of(scan, "EPSG:7854"), Foliage::unknown);
}

TEST(ScanEchoes, TheViewHoldsTheBeamUnlessTheOptionsRefuseIt) {
  BeamOptions options;
  options.range_resolution_m = 0.2;
  const auto view = view_of(scan_with(0.0136, 0.0119), {}, options);
  ASSERT_NE(view, nullptr);
  EXPECT_EQ(view->beam.divergence_rad, 0.0119);
  EXPECT_NEAR(view->behind_m, 0.16, 1e-12);
  tile::ScanEntry measured = scan_with(0.0136, 0.0119);
  measured.beam->range_resolution_m = 0.3;
  EXPECT_NEAR(view_of(measured, {}, options)->behind_m, 0.16, 1e-12);  // what the options say goes before
  options.range_resolution_m = 0;
  EXPECT_NEAR(view_of(measured, {}, options)->behind_m, 0.24, 1e-12);
  EXPECT_NEAR(view_of(scan_with(0.0136, 0.0119), {}, options)->behind_m, 0.12, 1e-12);
  options.enabled = false;
  EXPECT_EQ(view_of(scan_with(0.0136, 0.0119), {}, options), nullptr);
}

// 40 per metre of the diameter at two metres, at most 0.65, of the logarithm.
TEST(ScanEchoes, WideBeamsWhoseEchoesDoNotTellAreAsWrongAsCountingMakesThem) {
  IntegrationOptions options;
  options.shared_error = 0.03;
  const IntegrationOptions wide = integration_with_beam(options, scan_with(0.0136, 0.0119), {});  // 37.4 mm
  EXPECT_NEAR(wide.shared_error, std::hypot(0.03, 0.65), 1e-9);
  EXPECT_NEAR(integration_with_beam(options, scan_with(0.005, 0.001), {}).shared_error, std::hypot(0.03, 0.28), 1e-9);
  EXPECT_EQ(wide.height_share, options.height_share);
  EXPECT_LE(integration_with_beam(options, scan_with(0.2, 0.1), {}).shared_error, 1);  // what the options allow
  const std::string note = beam_note(scan_with(0.0136, 0.0119), {});
  EXPECT_NE(note.find("2020-01-20's lidar is 37 mm wide at 2 m"), std::string::npos) << note;
  EXPECT_NE(note.find("a factor of about 1.9 either way"), std::string::npos) << note;
}

TEST(ScanEchoes, WhatIsTakenOutLeavesLess) {
  EchoModel model;
  model.full_echo = 100, model.full_echo_error = 0.04, model.detection_share = 0.25, model.leaf_size_m2 = 0.0065;
  const IntegrationOptions options;
  const double with_model = integration_with_beam(options, scan_with(0.0136, 0.0119), model).shared_error;
  EXPECT_GT(with_model, options.shared_error);
  EXPECT_LT(with_model, 0.15);
  const std::string note = beam_note(scan_with(0.0136, 0.0119), model);
  EXPECT_NE(note.find("a full echo is 100 ± 4, the weakest 0.25 of it, leaves 65 cm²"), std::string::npos) << note;
  EXPECT_NE(note.find("not measured"), std::string::npos) << note;
}

TEST(ScanEchoes, AreasAreTrustedLessTheMoreIsInNoEchoAndTheLessTheFullEchoIsKnown) {
  const auto error = [](double full_echo_error, double lost_share, double leaves_per_resolution, double slope = 0) {
    EchoModel model{.full_echo = 100, .full_echo_error = full_echo_error, .leaf_size_from = LeafSizeFrom::pairs};
    model.lost_share = lost_share, model.leaves_per_resolution = leaves_per_resolution, model.angle_slope = slope;
    return integration_with_beam({.shared_error = 0}, scan_with(0.0136, 0.0119), model).shared_error;
  };
  EXPECT_NEAR(error(0, 0, 0), 0.6 * 0.02, 1e-9);
  EXPECT_NEAR(error(0.05, 0, 0), 0.6 * std::hypot(0.02, 0.8 * 0.05), 1e-9);
  EXPECT_NEAR(error(0.05, 0, 1), 0.6 * std::hypot(0.02, 2.2 * 0.05), 1e-9);
  EXPECT_NEAR(error(0, 0.1, 1), 0.6 * std::hypot(0.02, 0.9 * 0.1), 1e-9);
  EXPECT_NEAR(error(0.05, 0.1, 1), 0.6 * std::hypot(0.02, 0.11, 0.09), 1e-9);
  EXPECT_NEAR(error(0.05, 0.1, 1, 1.2), std::hypot(0.6 * std::hypot(0.02, 0.11, 0.09), 0.05 * 1.44), 1e-9);
}

TEST(ScanEchoes, WhereLeavesAreNotMeasuredAreasAreTrustedLess) {
  const auto error = [](LeafSizeFrom from) {
    const EchoModel model{.full_echo = 100, .full_echo_error = 0.04, .leaf_size_m2 = 0.0065, .leaf_size_from = from};
    return integration_with_beam({}, scan_with(0.0136, 0.0119), model).shared_error;
  };
  EXPECT_EQ(error(LeafSizeFrom::pairs), error(LeafSizeFrom::options));
  EXPECT_NEAR(error(LeafSizeFrom::nothing), std::hypot(error(LeafSizeFrom::pairs), 0.1), 1e-9);
}

TEST(ScanEchoes, BareVinesAreSaidToBe) {
  EchoModel model{.full_echo = 100, .full_echo_error = 0.3, .detection_share = 0.12};
  model.wood_returned = 0.8, model.lost_share = 0.1;  // which is of leaves
  const std::string note = beam_note(scan_with(0.0136, 0.0119), model);
  EXPECT_NE(note.find("as of bare vines"), std::string::npos) << note;
  EXPECT_NE(note.find("a full echo is 100, the weakest 0.12 of it, and 80 % of what canes take is in echoes"),
            std::string::npos)
      << note;
  EXPECT_NEAR(integration_with_beam({}, scan_with(0.0136, 0.0119), model).shared_error,
              std::hypot(IntegrationOptions{}.shared_error, 0.3), 1e-9);
}

TEST(ScanEchoes, WoodThatIsNotAsBrightAsLeavesIsSaidToBe) {
  EchoModel model{.full_echo = 100, .full_echo_error = 0.04};
  const auto error = [&] { return integration_with_beam({}, scan_with(0.0136, 0.0119), model).shared_error; };
  const auto said = [&] { return beam_note(scan_with(0.0136, 0.0119), model).find("wood is"); };
  const double of_leaves = error();
  model.wood_brightness = 0.6, model.wood_per_side = 0.18, model.wood_error = 0.1;
  EXPECT_NEAR(error(), std::hypot(of_leaves, 0.1), 1e-9);
  const std::string note = beam_note(scan_with(0.0136, 0.0119), model);
  EXPECT_NE(note.find("wood is 0.60 times as bright as leaves"), std::string::npos) << note;
  model.wood_brightness = 0.95;
  EXPECT_EQ(said(), std::string::npos);
  model.wood_brightness = 0.6, model.wood_per_side = 0;
  EXPECT_EQ(said(), std::string::npos);
}

TEST(ScanEchoes, CloudsWithoutDownwardMissesAreTrustedLess) {
  EchoModel model{.full_echo = 100, .full_echo_error = 0.04};
  const IntegrationOptions options;
  const auto error = [&] { return integration_with_beam(options, scan_with(0.0136, 0.0119), model).shared_error; };
  const double whole = error();
  EXPECT_EQ(beam_note(scan_with(0.0136, 0.0119), model).find("downward"), std::string::npos);
  model.lacks_downward_misses = true;
  EXPECT_NEAR(error(), std::hypot(whole, 0.15), 1e-9);
  const std::string note = beam_note(scan_with(0.0136, 0.0119), model);
  EXPECT_NE(note.find("lacks the downward rays without a return"), std::string::npos) << note;
}

TEST(ScanEchoes, AnAssumedRangeResolutionIsToldAndTrustedLess) {
  EchoModel model{.full_echo = 100, .full_echo_error = 0.04};
  model.range_resolution_m = 0.15;
  const IntegrationOptions options;
  const tile::ScanEntry scan = scan_with(0.0136, 0.0119);
  const auto error = [&] { return integration_with_beam(options, scan, model).shared_error; };
  const double known = error();
  EXPECT_EQ(beam_note(scan, model).find("range_resolution_m"), std::string::npos);
  EXPECT_NE(beam_note(scan, model).find("range resolution 15 cm"), std::string::npos);
  model.resolution_assumed = true, model.range_resolution_error_m = 0.04;
  EXPECT_NEAR(error(), std::hypot(known, 0.1 * 4 / 8), 1e-9);
  EXPECT_NE(beam_note(scan, model).find("15 ± 4 cm are assumed"), std::string::npos) << beam_note(scan, model);
  model.range_resolution_error_m = 0.12;
  EXPECT_NEAR(error(), std::hypot(known, 0.1), 1e-9);
}

TEST(ScanEchoes, TheGroundTellsTheRangeResolutionOfWideFirstEchoesThatAreSeenSteeplyToo) {
  const LidarBeam wide{0.0136, 0.0119, {}};
  EXPECT_TRUE(ground_tells_resolution(wide, true));
  EXPECT_FALSE(ground_tells_resolution(wide, false));
  LidarBeam other = wide;
  for (const auto& [mode, tells] : {std::pair(ReturnMode::first, true), std::pair(ReturnMode::strongest, false),
                                    std::pair(ReturnMode::last, false)}) {
    other.returns = mode;
    EXPECT_EQ(ground_tells_resolution(other, true), tells);
  }
  EXPECT_FALSE(ground_tells_resolution({0.005, 0.002, {}}, true));  // 15 mm at 5 m
}

TEST(ScanEchoes, VoxelsAreLookedAtWithTheRangeResolutionThatEchoesHave) {
  const auto view = std::make_shared<const BeamView>(BeamView{.beam = {0.0136, 0.0119, {}}, .behind_m = 0.12});
  EchoModel model;
  model.range_resolution_m = 0.25;
  EXPECT_NEAR(view_with(view, model)->behind_m, 0.8 * 0.25, 1e-12);
  EXPECT_EQ(view_with(view, model)->beam.range_resolution_m, 0.25);
  EXPECT_EQ(view_with(view, std::nullopt), nullptr);
  EXPECT_EQ(view_with(nullptr, model), nullptr);
}

TEST(ScanEchoes, LastEchoesAreTrustedLess) {
  const EchoModel model{.full_echo = 100, .full_echo_error = 0.04};
  const IntegrationOptions options;
  tile::ScanEntry scan = scan_with(0.0136, 0.0119);
  const auto error = [&] { return integration_with_beam(options, scan, model).shared_error; };
  const double unknown = error();
  for (const ReturnMode mode : {ReturnMode::first, ReturnMode::strongest}) {
    scan.beam->returns = mode;
    EXPECT_EQ(error(), unknown);
    EXPECT_EQ(beam_note(scan, model).find("last echo"), std::string::npos);
  }
  scan.beam->returns = ReturnMode::last;
  EXPECT_NEAR(error(), std::hypot(unknown, 0.05), 1e-9);
  EXPECT_NE(beam_note(scan, model).find("reports the last echo"), std::string::npos) << beam_note(scan, model);
}

TEST(ScanEchoes, ThatNothingSaysWhichEchoIsReportedIsTold) {
  const EchoModel model{.full_echo = 100, .full_echo_error = 0.04};
  tile::ScanEntry scan = scan_with(0.0136, 0.0119);
  EXPECT_NE(beam_note(scan, model).find("the first is assumed"), std::string::npos) << beam_note(scan, model);
  for (const ReturnMode mode : {ReturnMode::first, ReturnMode::strongest, ReturnMode::last}) {
    scan.beam->returns = mode;
    EXPECT_EQ(beam_note(scan, model).find("is assumed"), std::string::npos) << beam_note(scan, model);
  }
}

}  // namespace
}  // namespace rayfield::density
