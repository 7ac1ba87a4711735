#include "libdensity/echoes/silent_beams.h"

#include <gtest/gtest.h>

namespace rayfield::density {
namespace {

using Outcome = SilentBeams::Outcome;

void add(SilentBeams& beams, double cosine, bool through_row, Outcome outcome, int count, int intensity = 0) {
  for (int i = 0; i < count; ++i) beams.add(cosine, through_row, outcome, intensity);
}

// At each angle open ground answers a share of the beams; of those through rows the same share of what gets through
// does. Ground that is weaker because it is seen at a flatter angle falls silent when less is used up.
TEST(SilentBeams, WhatOpenGroundDoesNotAnswerIsNotUsedUp) {
  constexpr double kWeakest = 40;
  SilentBeams beams;
  add(beams, 0.41, false, Outcome::ground, 500, 110), add(beams, 0.41, false, Outcome::ground, 500, 90);
  add(beams, 0.41, true, Outcome::row, 600, 70), add(beams, 0.41, true, Outcome::ground, 300, 80);
  add(beams, 0.41, true, Outcome::nothing, 100);
  add(beams, 0.21, false, Outcome::ground, 800, 60), add(beams, 0.21, false, Outcome::nothing, 200);
  add(beams, 0.21, true, Outcome::row, 500, 70), add(beams, 0.21, true, Outcome::ground, 400, 50);
  add(beams, 0.21, true, Outcome::nothing, 200);  // 100 of them ground that does not answer
  ASSERT_TRUE(beams.used_up(kWeakest));
  EXPECT_NEAR(*beams.used_up(kWeakest), (100 * (1 - 30.0 / 100) + 100 * (1 - 30.0 / 60)) / 2100, 1e-12);
  EXPECT_NEAR(*beams.used_up(1000), 0, 1e-12);  // no ground would answer
}

TEST(SilentBeams, NothingIsSaidWhereGroundHardlyAnswersOrTooFewAreSeen) {
  SilentBeams beams;
  EXPECT_FALSE(beams.used_up(40));
  add(beams, 0.41, true, Outcome::nothing, 5000);
  EXPECT_FALSE(beams.used_up(40));  // no open ground
  add(beams, 0.41, false, Outcome::ground, 600, 50), add(beams, 0.41, false, Outcome::nothing, 400);
  EXPECT_FALSE(beams.used_up(40));  // which answers six of ten
  add(beams, 0.61, false, Outcome::ground, 100, 90), add(beams, 0.61, true, Outcome::ground, 1999, 90);
  EXPECT_FALSE(beams.used_up(40));
  add(beams, 0.61, true, Outcome::ground, 1, 90);
  EXPECT_EQ(*beams.used_up(40), 0);
}

TEST(SilentBeams, PartsAddUp) {
  SilentBeams whole, one, other;
  for (SilentBeams* beams : {&whole, &one}) add(*beams, 0.5, false, Outcome::ground, 200, 120);
  for (SilentBeams* beams : {&whole, &other})
    add(*beams, 0.5, true, Outcome::row, 1500, 70), add(*beams, 0.5, true, Outcome::nothing, 700);
  one += other;
  EXPECT_EQ(one, whole);
  EXPECT_NEAR(*one.used_up(40), 700.0 / 2200 * 0.75, 1e-12);
}

}  // namespace
}  // namespace rayfield::density
