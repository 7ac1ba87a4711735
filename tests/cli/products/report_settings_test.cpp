#include <gtest/gtest.h>

#include "cli/products/report_block.h"
#include "tests/core/options/option_members.h"

namespace rayfield::cli {
namespace {

TEST(ReportSettings, AreAllVisitedAndValidByDefault) {
  EXPECT_EQ(option_count<ReportSettings>(), aggregate_size<ReportSettings>());
  const auto checked = check_option_ranges(ReportSettings(), "cannot use");
  EXPECT_TRUE(checked) << checked.error().line();
}

}  // namespace
}  // namespace rayfield::cli
