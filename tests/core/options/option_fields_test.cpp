#include "rayfield/core/option_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/options/option_members.h"

namespace rayfield {
namespace {

enum class Colour { red, green };
inline constexpr OptionChoices<Colour, 2> kColours{{{"red", Colour::red}, {"green", Colour::green}}};

struct InnerOptions {
  double step_m = 0.5;
  std::optional<double> length_m;
  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("step_m", o.step_m, {0.1, 2}, "Of the steps");
    v.optional_number("length_m", o.length_m, {1, kUnbounded}, "Of all; none: as long as it is");
  }
};

struct OuterOptions {
  InnerOptions inner;
  int count = 3;
  bool enabled = true;
  Colour colour = Colour::green;
  std::vector<double> sizes_m = {0.3, 0.6};
  std::string folder;
  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("inner", o.inner);
    v.integer("count", o.count, {1, 10}, "How many");
    v.flag("enabled", o.enabled, "Whether at all");
    v.choice("colour", o.colour, kColours, "Of the lamp");
    v.numbers("sizes_m", o.sizes_m, {0.1, 5}, 3, "Of the voxels");
    v.text("folder", o.folder, "For what does not fit");
  }
};

struct ForgetfulOptions {
  double a = 1, b = 2;
  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("a", o.a, {}, "Named");
  }
};

TEST(OptionFields, AMemberThatIsLeftOutShowsInTheCounts) {
  EXPECT_EQ(option_count<InnerOptions>(), aggregate_size<InnerOptions>());
  EXPECT_EQ(option_count<OuterOptions>(), aggregate_size<OuterOptions>());
  EXPECT_EQ(aggregate_size<ForgetfulOptions>(), 2U);
  EXPECT_EQ(option_count<ForgetfulOptions>(), 1U);
}

TEST(OptionFields, RangesAreCheckedInGroupsTooAndNotANumberIsNeverInRange) {
  OuterOptions options;
  EXPECT_TRUE(check_option_ranges(options, "bad option"));
  options.inner.step_m = std::nan("");
  ASSERT_FALSE(check_option_ranges(options, "bad option"));
  EXPECT_EQ(check_option_ranges(options, "bad option").error().where, "inner.step_m");
  options.inner.step_m = 0.1;
  options.inner.length_m = 0.5;
  EXPECT_EQ(check_option_ranges(options, "bad option").error().where, "inner.length_m");
  options.inner.length_m = 1;
  options.sizes_m.clear();
  EXPECT_EQ(check_option_ranges(options, "bad option").error().where, "sizes_m");
}

TEST(OptionFields, NumbersStandInTheOrderOfTheFieldsAndTellEveryValueApart) {
  const OuterOptions options;
  EXPECT_THAT(option_numbers(options), testing::ElementsAre(0.5, INFINITY, 3, 1, 1, 2, 0.3, 0.6));
}

TEST(OptionFields, OptionsAreSetByTheirDottedKeys) {
  OuterOptions options;
  EXPECT_TRUE(set_option(options, "inner.step_m", 1.5, "bad option"));
  EXPECT_TRUE(set_option(options, "count", 7.0, "bad option"));
  EXPECT_TRUE(set_option(options, "enabled", false, "bad option"));
  EXPECT_TRUE(set_option(options, "colour", std::string("red"), "bad option"));
  EXPECT_TRUE(set_option(options, "sizes_m", std::vector<double>{1.0}, "bad option"));
  EXPECT_THAT(option_numbers(options), testing::ElementsAre(1.5, INFINITY, 7, 0, 0, 1, 1.0));
}

TEST(OptionFields, WrongKeysKindsAndValuesAreRefusedAndChangeNothing) {
  OuterOptions options;
  const std::vector<double> before = option_numbers(options);
  for (const auto& [key, value] : std::vector<std::pair<std::string, OptionValue>>{{"step_m", 1.0},
                                                                                   {"inner.step_m", 5.0},
                                                                                   {"inner.step_m", std::string("1")},
                                                                                   {"count", 2.5},
                                                                                   {"count", true},
                                                                                   {"colour", std::string("blue")},
                                                                                   {"enabled", 1.0},
                                                                                   {"sizes_m", 1.0}}) {
    const Result<void> result = set_option(options, key, value, "bad option");
    ASSERT_FALSE(result) << key;
    EXPECT_EQ(result.error().code, ErrorCode::usage);
  }
  EXPECT_EQ(option_numbers(options), before);
}

TEST(OptionFields, DescriptionsHoldDefaultRangeAndMeaning) {
  const std::vector<OptionDescription> fields = describe_options<OuterOptions>();
  ASSERT_EQ(fields.size(), 7U);
  EXPECT_EQ(fields[0].key, "inner.step_m");
  EXPECT_EQ(fields[0].default_value, "0.5");
  EXPECT_EQ(fields[0].range, "0.1 … 2");
  EXPECT_EQ(fields[1].default_value, "none");
  EXPECT_EQ(fields[1].range, "≥ 1");
  EXPECT_EQ(fields[4].default_value, "green");
  EXPECT_EQ(fields[4].range, "red, green");
}

}  // namespace
}  // namespace rayfield
