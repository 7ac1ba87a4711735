#pragma once

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {

/// The truth of a small site.
class TrueValues : public ::testing::Test {
 protected:
  TrueValues() : world(make_world(small_site())), drive(take(plan_drive(world))), result(take(truth(world, drive))) {}
  World world;
  Drive drive;
  Truth result;
};

}  // namespace rayfield::sim
