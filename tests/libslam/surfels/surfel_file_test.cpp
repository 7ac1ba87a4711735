#include "libslam/surfels/surfel_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/libslam/surfel_field.h"

namespace rayfield::slam {
namespace {

using testing::Field;

TEST(SurfelFile, GivesBackWhatItWasGivenInOrder) {
  const Field field(200000);
  EXPECT_EQ(field.file.size(), field.surfels.size());
  std::size_t at = 0;
  ASSERT_TRUE(field.file.for_each([&](std::span<const Surfel> piece) -> Result<void> {
    for (const Surfel& s : piece) {
      const Surfel& o = field.surfels[at++];
      EXPECT_TRUE(s.time_s == o.time_s && s.center == o.center && s.normal == o.normal && s.level == o.level &&
                  s.variance_m2 == o.variance_m2 && s.spin_rate_rad_s == o.spin_rate_rad_s);
    }
    return {};
  }));
  EXPECT_EQ(at, field.surfels.size());
}

TEST(SurfelFile, SaysWhereItCannotWrite) {
  SurfelFile file("/no/such/folder");
  const auto result = file.append(std::vector<Surfel>(100000));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resources);
  EXPECT_NE(result.error().line().find("/no/such/folder"), std::string::npos) << result.error().line();
}

}  // namespace
}  // namespace rayfield::slam
