#include "libdensity/leaf_angles/leaf_angle_arrays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace rayfield::density {
namespace {

// Each number another one, so that none can stand in another's place.
LeafAngleFit fit_of(const std::optional<LnRatio>& normals) {
  LeafAngleFit fit;
  fit.ln_ratio = 0.4, fit.error = 0.05, fit.measured = true, fit.spherical_looks = kSphericalLooksWide;
  fit.aspect.mean_cosine = 0.6, fit.aspect.apparent_side = 0.9, fit.leverage = 0.13, fit.wide_beams = true;
  fit.lost_share = 0.03, fit.normals = normals;
  return fit;
}

TEST(LeafAngleArrays, GiveBackTheFit) {
  for (const std::optional<LnRatio> normals : {std::optional<LnRatio>{}, std::optional(LnRatio{-0.3, 0.07})})
    for (const bool given : {false, true}) {
      LeafAngleFit fit = fit_of(normals);
      fit.given = given;
      const auto read = leaf_angles_from_arrays(arrays_from_leaf_angles(fit));
      ASSERT_TRUE(read) << read.error().line();
      EXPECT_EQ(std::pair(read->ln_ratio, read->error), std::pair(fit.ln_ratio, fit.error));
      EXPECT_EQ(std::pair(read->measured, read->given), std::pair(fit.measured, fit.given));
      EXPECT_EQ(std::pair(read->spherical_looks, read->leverage), std::pair(fit.spherical_looks, fit.leverage));
      EXPECT_EQ(read->aspect.mean_cosine, fit.aspect.mean_cosine);
      EXPECT_EQ(read->aspect.apparent_side, fit.aspect.apparent_side);
      EXPECT_EQ(std::pair(read->wide_beams, read->lost_share), std::pair(fit.wide_beams, fit.lost_share));
      ASSERT_EQ(read->normals.has_value(), normals.has_value());
      if (normals) {
        EXPECT_EQ(std::pair(read->normals->value, read->normals->error), std::pair(-0.3, 0.07));
      }
    }
}

TEST(LeafAngleArrays, OfEarlierVersionsHaveFewerNumbers) {
  tile::ArraySet arrays = arrays_from_leaf_angles(fit_of({}));
  const auto stored = arrays.column<double>("fit").value();
  const std::vector<double> all(stored.begin(), stored.end());
  for (const std::size_t count : {3U, 4U, 6U, 7U, 11U}) {
    arrays.columns["fit"] = std::vector<double>(all.begin(), all.begin() + static_cast<long>(count));
    const auto read = leaf_angles_from_arrays(arrays);
    ASSERT_TRUE(read) << count;
    EXPECT_EQ(read->ln_ratio, 0.4);
    EXPECT_EQ(read->leverage, count > 6 ? 0.13 : kUsualLeverage);
    EXPECT_EQ(read->lost_share, 0);
    EXPECT_FALSE(read->normals);
  }
}

TEST(LeafAngleArrays, ThatCannotBeAreDamaged) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::size_t, double>> cannot_be = {{0, kNaN}, {0, 4},  {1, -1},    {1, kNaN}, {3, 0},
                                                                 {3, 2},    {4, 0},  {5, 9},     {6, -1},   {8, 7},
                                                                 {8, kNaN}, {9, -1}, {11, -0.1}, {11, 2}};
  for (const auto& [place, value] : cannot_be) {
    tile::ArraySet arrays = arrays_from_leaf_angles(fit_of(LnRatio{0.5, 0.1}));
    auto numbers = arrays.column<double>("fit").value();
    std::vector<double> changed(numbers.begin(), numbers.end());
    changed[place] = value;
    arrays.columns["fit"] = changed;
    const auto read = leaf_angles_from_arrays(arrays);
    ASSERT_FALSE(read) << place << ": " << value;
    EXPECT_EQ(read.error().code, ErrorCode::damaged);
  }
  tile::ArraySet none = arrays_from_leaf_angles({});
  none.columns["fit"] = std::vector<double>(5, 0.5);
  EXPECT_FALSE(leaf_angles_from_arrays(none)) << "another number of values";
  none.columns.clear();
  EXPECT_FALSE(leaf_angles_from_arrays(none)) << "no fit";
}

}  // namespace
}  // namespace rayfield::density
