#include "formats/ray_cloud/beam_comment.h"

#include <gtest/gtest.h>

namespace rayfield::formats {
namespace {

TEST(BeamComment, ComesBackToTheLastDigit) {
  for (const LidarBeam& beam :
       {LidarBeam{0.0136, 0.0119, {}}, LidarBeam{1.0 / 3e2, 1.0 / 7e2, 0.257}, LidarBeam{0, 0, {}},
        LidarBeam{0.01, 1e-7, 1}, LidarBeam{0.01, 0.003, {}, 0.1 / 7}, LidarBeam{0.01, 0.003, 0.2, 0.15},
        LidarBeam{0.01, 0.003, {}, {}, ReturnMode::strongest}, LidarBeam{0.01, 0.003, 0.2, 0.15, ReturnMode::first}})
    EXPECT_EQ(parse_beam_comment(beam_comment(beam)), beam) << beam_comment(beam);
}

// raycloudtools looks for these words in every line of a header.
TEST(BeamComment, HoldsNoWordThatOtherReadersTakeForAColumn) {
  const std::string text = beam_comment({0.0136, 0.0119, 0.25, 0.15, ReturnMode::last});
  for (const char* word : {"time", "intensity", "property"}) EXPECT_EQ(text.find(word), std::string::npos) << word;
}

TEST(BeamComment, WhatMakesNoBeamIsLeftAlone) {
  for (const char* text :
       {"", "crs EPSG:7854", "beam", "beam diameter_m 0.01", "beam diameter_m x divergence_rad 0.01",
        "beam diameter_m -0.01 divergence_rad 0.01", "beam diameter_m 0.01 divergence_rad 3",
        "beam diameter_m nan divergence_rad 0.01", "beam diameter_m 0.01 divergence_rad 0.01 detection_share 2",
        "beam diameter_m 0.01 divergence_rad 0.01 detection_share 0",
        "beam diameter_m 0.01 divergence_rad 0.01 range_resolution_m 0",
        "beam diameter_m 0.01 divergence_rad 0.01 range_resolution_m 3",
        "beam diameter_m 0.01 divergence_rad 0.01 returns", "beam diameter_m 0.01 divergence_rad 0.01 returns loudest",
        "beam diameter_m 0.01 divergence_rad 0.01 returns firstly",
        "beam diameter_m 0.01 divergence_rad 0.01 returns first more", "beam diameter_m 0.01 divergence_rad 0.01 more"})
    EXPECT_FALSE(parse_beam_comment(text)) << text;
}

}  // namespace
}  // namespace rayfield::formats
