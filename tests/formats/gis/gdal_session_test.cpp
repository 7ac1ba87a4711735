#include "formats/gis/gdal_session.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <thread>

namespace rayfield::formats {
namespace {

// In threads of their own, as PROJ opens its database once for each.
TEST(ParseCrs, ADatabaseThatCannotBeOpenedIsNoFaultOfTheCrs) {
  Error error;
  const auto parse = [&error] {
    const GdalSession quiet;
    if (const auto crs = parse_crs("EPSG:2056", "cannot write", "map.tif"); !crs) error = crs.error();
  };
  // With files to be had the CRS is known. UBSan has then seen the types of objects, for which it opens a pipe.
  std::thread(parse).join();
  ASSERT_TRUE(error.what.empty()) << error.line();
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none_left = before;
  none_left.rlim_cur = 3;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none_left), 0);
  std::thread(parse).join();
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
