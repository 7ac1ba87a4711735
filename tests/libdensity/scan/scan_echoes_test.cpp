#include "libdensity/scan/beam_width.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::density {
namespace {

tile::ScanEntry scan_with(double diameter_m, double divergence_rad) {
  tile::ScanEntry scan;
  scan.scan_id = "2020-01-20";
  scan.beam = LidarBeam{diameter_m, divergence_rad, {}};
  return scan;
}

TEST(BeamWidth, UnknownAndThinBeamsAddNoError) {
  const IntegrationOptions options;
  EXPECT_EQ(integration_with_beam(options, tile::ScanEntry{}).shared_error, options.shared_error);
  EXPECT_EQ(integration_with_beam(options, scan_with(0, 0)).shared_error, options.shared_error);
  EXPECT_EQ(beam_note(tile::ScanEntry{}), "");
  EXPECT_EQ(beam_note(scan_with(0, 0)), "");
}

TEST(BeamWidth, WideBeamsAddEightPerMetreOfTheirDiameterAtTwoMetres) {
  IntegrationOptions options;
  options.shared_error = 0.03;
  const IntegrationOptions wide = integration_with_beam(options, scan_with(0.0136, 0.0119));  // 37.4 mm
  EXPECT_NEAR(wide.shared_error, std::hypot(0.03, 0.2992), 1e-9);
  EXPECT_EQ(wide.height_share, options.height_share);
  EXPECT_LE(integration_with_beam(options, scan_with(0.2, 0.1)).shared_error, 1);  // what the options allow
  const std::string note = beam_note(scan_with(0.0136, 0.0119));
  EXPECT_NE(note.find("2020-01-20's lidar is 37 mm wide at 2 m"), std::string::npos) << note;
  EXPECT_NE(note.find("30 %"), std::string::npos) << note;
}

}  // namespace
}  // namespace rayfield::density
