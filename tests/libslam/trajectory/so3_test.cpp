#include "libslam/trajectory/so3.h"

#include <gtest/gtest.h>

#include <random>

namespace rayfield::slam {
namespace {

TEST(So3, ExpAndLogAreInverseUpToHalfATurn) {
  std::mt19937 generator(1);
  std::normal_distribution<double> gauss(0, 1);
  for (int k = 0; k < 1000; ++k) {
    Eigen::Vector3d phi(gauss(generator), gauss(generator), gauss(generator));
    phi *= std::pow(10.0, -k % 12) * 3.1 / std::max(3.1, phi.norm());
    EXPECT_LT((log_so3(exp_so3(phi)) - phi).norm(), 1e-12 + 1e-10 * phi.norm());
  }
}

}  // namespace
}  // namespace rayfield::slam
