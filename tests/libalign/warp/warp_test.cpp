#include "rayfield/align/warp.h"

#include <gtest/gtest.h>

namespace rayfield::align {
namespace {

Warp ramp() {
  Warp warp;
  warp.origin = {100, 200}, warp.spacing_m = 10, warp.nx = 6, warp.ny = 5;
  for (int iy = 0; iy < warp.ny; ++iy)
    for (int ix = 0; ix < warp.nx; ++ix) warp.control.emplace_back(0.01 * ix, -0.02 * iy, 0.5);
  return warp;
}

TEST(Warp, ReproducesALinearDisplacement) {
  const Warp warp = ramp();
  // Control point i of a cubic B-spline stands (i − 1) spans from the origin.
  const Eigen::Vector3d d = warp.at({113, 208});
  EXPECT_NEAR(d.x(), 0.01 * (1.3 + 1), 1e-12);
  EXPECT_NEAR(d.y(), -0.02 * (0.8 + 1), 1e-12);
  EXPECT_NEAR(d.z(), 0.5, 1e-12);
}

TEST(Warp, GoesOnUnchangedBeyondItsLattice) {
  const Warp warp = ramp();
  EXPECT_EQ(warp.at({500, 208}), warp.at({130, 208}));
  EXPECT_EQ(warp.at({113, -900}), warp.at({113, 200}));
  EXPECT_EQ(Warp().at({1, 2}), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace rayfield::align
