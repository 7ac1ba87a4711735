#include "formats/gis/gdal_session.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <thread>

namespace rayfield::formats {
namespace {

// In a thread of its own, as PROJ opens its database once for each.
TEST(ParseCrs, ADatabaseThatCannotBeOpenedIsNoFaultOfTheCrs) {
  { const GdalSession registered; }
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none_left = before;
  none_left.rlim_cur = 3;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none_left), 0);
  Error error;
  std::thread([&error] {
    const GdalSession quiet;
    if (const auto crs = parse_crs("EPSG:2056", "cannot write", "map.tif"); !crs) error = crs.error();
  }).join();
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(error.code, ErrorCode::resources) << error.line();
  EXPECT_NE(error.why.find("proj.db"), std::string::npos) << error.why;
}

TEST(ParseCrs, ACrsThatNobodyKnowsIsWrongUsage) {
  const GdalSession quiet;
  const auto crs = parse_crs("EPSG:99999", "cannot write", "map.tif");
  ASSERT_FALSE(crs);
  EXPECT_EQ(crs.error().code, ErrorCode::usage) << crs.error().line();
}

}  // namespace
}  // namespace rayfield::formats
