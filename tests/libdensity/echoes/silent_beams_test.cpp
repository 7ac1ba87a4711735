#include "libdensity/echoes/silent_beams.h"

#include <gtest/gtest.h>

namespace rayfield::density {
namespace {

using Outcome = SilentBeams::Outcome;

void add(SilentBeams& beams, double cosine, bool through_row, Outcome outcome, int count) {
  for (int i = 0; i < count; ++i) beams.add(cosine, through_row, outcome);
}

// At each angle open ground answers a share of the beams; of those through rows the same share of what gets through
// does.
TEST(SilentBeams, WhatOpenGroundDoesNotAnswerIsNotUsedUp) {
  SilentBeams beams;
  add(beams, 0.41, false, Outcome::ground, 1000);
  add(beams, 0.41, true, Outcome::row, 600), add(beams, 0.41, true, Outcome::ground, 300);
  add(beams, 0.41, true, Outcome::nothing, 100);
  add(beams, 0.21, false, Outcome::ground, 800), add(beams, 0.21, false, Outcome::nothing, 200);
  add(beams, 0.21, true, Outcome::row, 500), add(beams, 0.21, true, Outcome::ground, 400);
  add(beams, 0.21, true, Outcome::nothing, 200);  // 100 of them ground that does not answer
  ASSERT_TRUE(beams.share());
  EXPECT_NEAR(*beams.share(), 200.0 / 2100, 1e-12);
}

TEST(SilentBeams, NothingIsSaidWhereGroundHardlyAnswersOrTooFewAreSeen) {
  SilentBeams beams;
  EXPECT_FALSE(beams.share());
  add(beams, 0.41, true, Outcome::nothing, 5000);
  EXPECT_FALSE(beams.share());  // no open ground
  add(beams, 0.41, false, Outcome::ground, 600), add(beams, 0.41, false, Outcome::nothing, 400);
  EXPECT_FALSE(beams.share());  // which answers six of ten
  add(beams, 0.61, false, Outcome::ground, 100), add(beams, 0.61, true, Outcome::ground, 1999);
  EXPECT_FALSE(beams.share());
  add(beams, 0.61, true, Outcome::ground, 1);
  EXPECT_EQ(*beams.share(), 0);
}

TEST(SilentBeams, PartsAddUp) {
  SilentBeams whole, one, other;
  for (SilentBeams* beams : {&whole, &one}) add(*beams, 0.5, false, Outcome::ground, 200);
  for (SilentBeams* beams : {&whole, &other})
    add(*beams, 0.5, true, Outcome::row, 1500), add(*beams, 0.5, true, Outcome::nothing, 700);
  one += other;
  EXPECT_EQ(one, whole);
  EXPECT_NEAR(*one.share(), 700.0 / 2200, 1e-12);
}

}  // namespace
}  // namespace rayfield::density
