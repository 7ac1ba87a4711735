#include "rayfield/experiments/spinning.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::experiments {
namespace {

constexpr std::uint64_t kTrials = 3000;

class Spinning : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SpinningOptions options;
    options.trials = kTrials;
    Progress progress;
    result_ = new Result<SpinningResult>(run_spinning(options, progress));
  }
  static void TearDownTestSuite() { delete result_; }
  static const SpinningRow& row(std::size_t i) { return (*result_)->rows.at(i); }
  static Result<SpinningResult>* result_;
};
Result<SpinningResult>* Spinning::result_ = nullptr;

constexpr auto kSphere = static_cast<std::size_t>(NormalBody::sphere),
               kCube = static_cast<std::size_t>(NormalBody::cube);

double off(const Mean& a, const Mean& b) {
  return std::abs(a.value - b.value) / std::hypot(a.standard_error, b.standard_error);
}

// E|n·x| is 10/11 for normals stretched along x (leaf_triangles_test.cpp), ½ for those of a sphere.
TEST_F(Spinning, LeavesWithoutSizeReadTwiceTheirMeanProjection) {
  const Mean stretched = row(0).trawling[kSphere].infinitesimal, even = row(3).trawling[kSphere].infinitesimal;
  EXPECT_NEAR(stretched.value, 2 * 10.0 / 11 - 1, 4.5 * stretched.standard_error);
  EXPECT_NEAR(even.value, 0, 4.5 * even.standard_error);
}

TEST_F(Spinning, RaysAlongXSeeNormalsAlongYAndZAlike) {
  for (const std::size_t body : {kSphere, kCube})
    EXPECT_LT(off(row(1).trawling[body].debiased, row(2).trawling[body].debiased), 4) << "the paper's cells differ";
}

TEST_F(Spinning, LevelLeavesLookAlikeFromEverySide) {
  EXPECT_LT(off(row(2).trawling[kSphere].debiased, row(2).spinning[kSphere].debiased), 4);
}

TEST_F(Spinning, TurningTheRaysBringsBothErrorsOfUprightLeavesDown) {
  for (const std::size_t body : {kSphere, kCube})
    for (const std::size_t i : {0U, 1U})
      EXPECT_LT(std::abs(row(i).spinning[body].debiased.value), std::abs(row(i).trawling[body].debiased.value) - 0.2);
}

TEST_F(Spinning, NormalsFromACubeGiveThePapersSpinningColumn) {
  for (const SpinningRow& r : (*result_)->rows)
    EXPECT_LT(std::abs(paper_deviations(r.paper_spinning, r.spinning[kCube].debiased, kTrials)), 3.5)
        << r.eccentricity.transpose();
}

TEST_F(Spinning, ThePapersTrawlingCellsOfUprightLeavesAreOutOfReach) {
  for (const std::size_t i : {0U, 1U})
    for (const std::size_t body : {kSphere, kCube})
      EXPECT_GT(std::abs(paper_deviations(row(i).paper_trawling, row(i).trawling[body].debiased, kTrials)), 6);
}

// A tenth apart, 0.02 and √(900/400)·0.02 of standard error: 0.1/(0.02·√(1 + 2.25)).
TEST(PaperDeviations, CountTheStandardErrorsOfBoth) {
  EXPECT_NEAR(paper_deviations(0.3, {0.2, 0.02}, 900), 0.1 / (0.02 * std::sqrt(3.25)), 1e-12);
}

TEST(SpinningOptions, RefusesWhatIsOutOfRange) {
  Progress progress;
  SpinningOptions options;
  options.rays = 1;
  EXPECT_EQ(run_spinning(options, progress).error().where, "rays");
}

}  // namespace
}  // namespace rayfield::experiments
