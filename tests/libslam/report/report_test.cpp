#include "rayfield/slam/report.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace rayfield::slam {
namespace {

TEST(ReportJson, IsJsonWhateverStandsInItsTexts) {
  SlamReport r;
  r.frame_note = "quote \" backslash \\ newline \n bell \a end";
  r.surfel_thickness_m = std::numeric_limits<double>::quiet_NaN();
  r.warnings = {"a", "b\tc"};
  r.uncertainty.push_back({1.5e9, {0.01, 0.02, 0.03}, {1e-3, 2e-3, 3e-3}});
  r.stages.push_back({"stage", 2.0, 50.0});
  const auto j = nlohmann::json::parse(report_json(r));
  EXPECT_EQ(j["frame"], r.frame_note);
  EXPECT_TRUE(j["surfel_thickness_m"].is_null());
  EXPECT_EQ(j["warnings"].size(), 2u);
  EXPECT_DOUBLE_EQ(j["uncertainty"][0]["translation_m"][2], 0.03);
  EXPECT_DOUBLE_EQ(j["stages"][0]["real_time_factor"], 50.0);
}

}  // namespace
}  // namespace rayfield::slam
