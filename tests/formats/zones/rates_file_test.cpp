#include "rayfield/formats/rates_file.h"

#include <gtest/gtest.h>

#include "tests/formats/temporary_file.h"
#include "tests/formats/zones/zone_support.h"

namespace rayfield::formats {
namespace {

using testing::drawn_map;
using testing::TemporaryFile;

Result<Prescription> read(const std::string& text, const std::string& unit = "l/ha") {
  const TemporaryFile file(text, ".csv");
  return read_rates(file.path(), unit, "Copper", drawn_map(60).zones);
}

void expect_refused(const std::string& text, const std::string& why) {
  const auto rates = read(text);
  ASSERT_FALSE(rates) << text;
  EXPECT_EQ(rates.error().code, ErrorCode::bad_input);
  EXPECT_NE(rates.error().line().find(why), std::string::npos) << rates.error().line();
}

TEST(Rates, AreReadFromCommasSemicolonsAndTabs) {
  for (const char* text : {"zone,rate\n1,150\n2,225.5\n3,300\n", "zone;rate;note\n3;300;x\n1;150;\n2;225.5;\n",
                           "rate\tzone\r\n150\t1\r\n225.5\t2\r\n300\t3\r\n"}) {
    const auto rates = read(text, "L/HA");
    ASSERT_TRUE(rates) << rates.error().line();
    EXPECT_EQ(rates->rates, (std::vector<double>{150, 225.5, 300}));
    EXPECT_EQ(rates->unit, "l/ha");
  }
}

TEST(Rates, WhatIsMissingUnknownOrNoRateIsRefused) {
  expect_refused("zone,rate\n1,150\n2,225\n", "zone 3 has no rate");
  expect_refused("zone,rate\n1,1\n2,2\n3,3\n4,4\n", "zone 4: the block has zones 1 to 3");
  expect_refused("zone,rate\n1,1\n2,2\n3,3\n3,4\n", "zone 3 again");
  expect_refused("zone,rate\n1,1\n2,lots\n3,3\n", "'lots'");
  expect_refused("zone,rate\n1,1\n2,2,5\n3,nan\n", "'nan'");
  expect_refused("zone,rate\n1,-1\n2,2\n3,3\n", "out of range");
  expect_refused("zone,rate\n1,1e9\n2,2\n3,3\n", "out of range");
  expect_refused("zone,rate\n=1+1,1\n2,2\n3,3\n", "'=1+1'");
  expect_refused("zone,dose\n1,1\n2,2\n3,3\n", "no columns");
  expect_refused("", "");
}

TEST(Rates, UnknownUnitsAndNamelessProductsAreUsageErrors) {
  const TemporaryFile file("zone,rate\n1,1\n2,2\n3,3\n", ".csv");
  const auto zones = drawn_map(60).zones;
  const auto unit = read_rates(file.path(), "buckets", "Copper", zones),
             none = read_rates(file.path(), "l/ha", "", zones);
  ASSERT_FALSE(unit);
  EXPECT_EQ(unit.error().code, ErrorCode::usage);
  EXPECT_NE(unit.error().next.find("kg/ha"), std::string::npos);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::usage);
  EXPECT_FALSE(read_rates(file.path() + ".none", "l/ha", "Copper", zones));
}

}  // namespace
}  // namespace rayfield::formats
