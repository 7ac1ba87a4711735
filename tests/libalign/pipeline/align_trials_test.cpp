#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/libalign/synthetic_block.h"

namespace rayfield::align {
namespace {

// Sites, dates and errors drawn at random; a drive covers all rows, some of them, or a part of their length. What is
// not laid in its place to 3 cm must have been refused, and of whole drives none may be.
TEST(Align, NoSlipInTwoHundredTrials) {
  std::mt19937 random(20260101);
  std::uniform_real_distribution<double> uniform;
  int refused_parts = 0, parts = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SyntheticBlock block;
    block.seed = static_cast<unsigned>(1000 + trial);
    block.rows = 2 + static_cast<int>(uniform(random) * 8);
    block.panel_m = 5 + 3 * uniform(random);
    block.vine_m = block.panel_m / (3 + static_cast<int>(uniform(random) * 3));
    block.length_m = block.panel_m * (4 + static_cast<int>(uniform(random) * 12));
    block.spacing_m = 1.8 + 1.8 * uniform(random);
    block.azimuth_rad = 2 * std::numbers::pi * uniform(random);
    block.slope = 0.08 * uniform(random);
    block.relief_m = 0.5 * uniform(random);
    block.missing = 0.08 * uniform(random);
    SyntheticDrive first, second;
    first.seed = static_cast<unsigned>(2 * trial), second.seed = static_cast<unsigned>(2 * trial + 1);
    first.detection = 0.5 + 0.45 * uniform(random), second.detection = 0.5 + 0.45 * uniform(random);
    first.noise_m = 0.006 + 0.01 * uniform(random), second.noise_m = 0.006 + 0.01 * uniform(random);
    second.error = random_error(block, random);
    const bool part = trial % 3 == 2 && block.rows > 2;
    if (part && trial % 2 == 0) second.last_row = block.rows / 2;
    if (part && trial % 2 == 1) second.to_m = 0.6 * block.length_m;
    parts += part;
    const auto found = align_landmarks(drive_along(block, first), drive_along(block, second), {}, "scan");
    if (!found) {
      refused_parts += part;
      EXPECT_TRUE(part) << "trial " << trial << ": " << found.error().why;
      continue;
    }
    EXPECT_LT(miss_of(block, second, *found).middle_m, 0.03) << "trial " << trial << ", margin " << found->margin;
  }
  EXPECT_LE(refused_parts, parts / 10);
}

}  // namespace
}  // namespace rayfield::align
