#include "rayfield/align/options.h"

#include <gtest/gtest.h>

#include "tests/core/options/option_members.h"

namespace rayfield::align {
namespace {

template <class Options>
class EveryAlignmentOption : public ::testing::Test {};
using OptionStructs = ::testing::Types<SearchOptions, AcceptOptions, WarpOptions, AlignOptions>;
TYPED_TEST_SUITE(EveryAlignmentOption, OptionStructs);

TYPED_TEST(EveryAlignmentOption, IsVisitedAndValidByDefault) {
  EXPECT_EQ(option_count<TypeParam>(), aggregate_size<TypeParam>());
  const auto checked = check_option_ranges(TypeParam(), "cannot use");
  EXPECT_TRUE(checked) << checked.error().line();
}

TEST(AlignOptions, RefuseValuesOutOfRangeInAnyGroup) {
  AlignOptions options;
  options.accept.max_residual_m = 0;
  const auto refused = options.validate();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_EQ(refused.error().where, "accept.max_residual_m");
}

}  // namespace
}  // namespace rayfield::align
