#include "formats/vehicle/lidar_models.h"

#include <gtest/gtest.h>

namespace rayfield::formats {
namespace {

TEST(LidarModels, AreFoundHoweverTheyAreWritten) {
  const LidarBeam* sick = beam_of_model("LMS511");
  ASSERT_NE(sick, nullptr);
  // SICK's data sheet: spot of 13.6 mm + 11.9 mrad · range at standard resolution.
  EXPECT_DOUBLE_EQ(sick->diameter_at(10), 0.0136 + 0.119);
  EXPECT_FALSE(sick->detection_share);
  for (const char* name : {"SICK LMS511", "lms-511", "sick_lms_511"}) EXPECT_EQ(beam_of_model(name), sick) << name;
  for (const char* name : {"Velodyne VLP-16", "Ouster OS0", "OS1", "Livox Mid-70", "LMS-200", "LMS111"})
    EXPECT_NE(beam_of_model(name), nullptr) << name;
  EXPECT_EQ(beam_of_model("LMS999"), nullptr);
  EXPECT_EQ(beam_of_model(""), nullptr);
}

TEST(LidarModels, AreRecognisedAtTheBeginningOfAWord) {
  EXPECT_EQ(model_in_name("/os1_cloud_node/points"), "OS1");
  EXPECT_EQ(model_in_name("laser /sick/lms_511/scan"), "LMS511");
  EXPECT_EQ(model_in_name("vlp-16"), "VLP16");
  EXPECT_EQ(model_in_name("/lidar_pos0/scan"), "");
  EXPECT_EQ(model_in_name("/velodyne_points"), "");
}

}  // namespace
}  // namespace rayfield::formats
