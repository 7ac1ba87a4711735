#include "formats/picture/color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

/// CIE L*a*b* (D65) of an sRGB colour.
std::array<double, 3> lab(const Rgba& color) {
  std::array<double, 3> linear{};
  const std::array<double, 3> encoded = {color.r / 255.0, color.g / 255.0, color.b / 255.0};
  for (std::size_t i = 0; i < 3; ++i) {
    linear[i] = encoded[i] <= 0.04045 ? encoded[i] / 12.92 : std::pow((encoded[i] + 0.055) / 1.055, 2.4);
  }
  const double x = (0.4124564 * linear[0] + 0.3575761 * linear[1] + 0.1804375 * linear[2]) / 0.95047;
  const double y = 0.2126729 * linear[0] + 0.7151522 * linear[1] + 0.0721750 * linear[2];
  const double z = (0.0193339 * linear[0] + 0.1191920 * linear[1] + 0.9503041 * linear[2]) / 1.08883;
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  return {116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))};
}

double difference(const Rgba& a, const Rgba& b) {
  const auto p = lab(a), q = lab(b);
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(Color, LightnessIsMonotonicAndEqualStepsLookEqual) {
  for (const Ramp ramp : {Ramp::canopy, Ramp::height, Ramp::uncertainty, Ramp::terrain}) {
    const auto stops = ramp_stops(ramp);
    double total = 0;
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) total += difference(stops[i], stops[i + 1]);
    const double mean = total / static_cast<double>(stops.size() - 1);
    const double sign = ramp == Ramp::terrain ? 1 : -1;
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
      EXPECT_NEAR(difference(stops[i], stops[i + 1]), mean, 0.1 * mean) << "ramp " << static_cast<int>(ramp);
      EXPECT_GT(sign * (lab(stops[i + 1])[0] - lab(stops[i])[0]), 0);
    }
  }
}

TEST(Color, TheRampOfChangesIsLightInTheMiddleDarkAtBothEndsAndItsStepsLookEqual) {
  const auto stops = ramp_stops(Ramp::change);
  ASSERT_EQ(stops.size(), 11U);
  double total = 0;
  for (std::size_t i = 0; i < 10; ++i) total += difference(stops[i], stops[i + 1]);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(difference(stops[i], stops[i + 1]), total / 10, 0.1 * total / 10);
    EXPECT_GT((i < 5 ? 1 : -1) * (lab(stops[i + 1])[0] - lab(stops[i])[0]), 0);
  }
  EXPECT_GT(lab(stops[5])[0], 95);
  // Equal gain and loss are equally strong, and no change is the colour of neither.
  for (std::size_t i = 1; i <= 5; ++i) EXPECT_NEAR(lab(stops[5 - i])[0], lab(stops[5 + i])[0], 8);
  const ColorScale scale = product_scale("plan_density_change", -1, 2);
  EXPECT_EQ(scale.low, -scale.high);
  EXPECT_EQ(color_at(scale, 0), stops[5]);
}

/// How a deuteranope or protanope sees it (Viénot, Brettel and Mollon 1999).
Rgba as_seen_without(char cone, const Rgba& color) {
  const auto linear = [](std::uint8_t v) {
    const double e = v / 255.0;
    return e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
  };
  const double r = linear(color.r), g = linear(color.g), b = linear(color.b);
  double l = 17.8824 * r + 43.5161 * g + 4.11935 * b, m = 3.45565 * r + 27.1554 * g + 3.86714 * b;
  const double s = 0.0299566 * r + 0.184309 * g + 1.46709 * b;
  if (cone == 'm') m = 0.494207 * l + 1.24827 * s;
  if (cone == 'l') l = 2.02344 * m - 2.52581 * s;
  const auto encode = [](double v) {
    v = std::clamp(v, 0.0, 1.0);
    return static_cast<std::uint8_t>(
        std::lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
  };
  return {encode(0.0809444479 * l - 0.130504409 * m + 0.116721066 * s),
          encode(-0.0102485335 * l + 0.0540193266 * m - 0.113614708 * s),
          encode(-0.000365296938 * l - 0.00412161469 * m + 0.693511405 * s)};
}

TEST(Color, GainAndLossDifferForThoseWhoCannotTellRedFromGreen) {
  const auto stops = ramp_stops(Ramp::change);
  for (const char cone : {'l', 'm'})
    for (std::size_t i = 1; i <= 5; ++i) {
      const Rgba loss = as_seen_without(cone, stops[5 - i]), gain = as_seen_without(cone, stops[5 + i]);
      EXPECT_GT(difference(loss, gain), i == 1 ? 10 : 30) << cone << " step " << i;
    }
}

TEST(Color, ZeroIsLightAndNanIsTransparent) {
  const ColorScale scale = product_scale("plan_density", 2, 3);
  EXPECT_GT(lab(color_at(scale, 0))[0], 95);
  EXPECT_EQ(color_at(scale, testing::kNan).a, 0);
}

TEST(Color, ValuesBeyondTheScaleTakeTheEndColoursAndStopsAreHitExactly) {
  const ColorScale scale{10, 20, Ramp::height};
  const auto stops = ramp_stops(Ramp::height);
  EXPECT_EQ(color_at(scale, -1e30), stops.front());
  EXPECT_EQ(color_at(scale, 1e30), stops.back());
  EXPECT_EQ(color_at(scale, 13), stops[3]);
}

TEST(Color, DensityScalesDoNotDependOnTheDataAndGroundTakesWholeMetres) {
  for (const char* product :
       {"plan_density", "plan_density_se", "canopy_height", "leaf_area_per_m", "side_view_row_3"}) {
    const ColorScale a = product_scale(product, 0, 1), b = product_scale(product, 3, 40);
    EXPECT_EQ(a.low, b.low) << product;
    EXPECT_EQ(a.high, b.high) << product;
  }
  const ColorScale ground = product_scale("ground", 81.3, 83.9);
  EXPECT_EQ(ground.low, 81);
  EXPECT_EQ(ground.high, 84);
  const ColorScale flat = product_scale("ground", 82, 82);
  EXPECT_LT(flat.low, flat.high);
  const ColorScale empty = product_scale("ground", testing::kNan, testing::kNan);
  EXPECT_LT(empty.low, empty.high);
}

TEST(Color, TicksAreRoundAndStayInside) {
  EXPECT_EQ(nice_ticks(0, 8, 8), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(nice_ticks(-0.9, 0.9, 4), (std::vector<double>{-0.5, 0, 0.5}));
  EXPECT_TRUE(nice_ticks(1, 1, 5).empty());
  EXPECT_TRUE(nice_ticks(0, testing::kNan, 5).empty());
  EXPECT_EQ(tick_text(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_text(-0.0, 1), "0");
  EXPECT_EQ(tick_text(-20, 10), "-20");
}

}  // namespace
}  // namespace rayfield::formats
