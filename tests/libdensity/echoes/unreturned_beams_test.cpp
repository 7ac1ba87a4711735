#include "libdensity/echoes/unreturned_beams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rayfield::density {
namespace {

constexpr double kNarrow = 0, kWide = 0.5;  // no beam is cut by the edge of a leaf; every one is

// Beams cut anywhere by leaves of one brightness: the share t of them does not return, each of t/2 in the mean, so that
// t² of what leaves take is hidden; and as much strength is lost, of which 1.2 times that is said.
TEST(UnreturnedBeams, OfEquallyBrightLeavesHideWhatIsLost) {
  for (const double t : {0.1, 0.25, 0.4}) EXPECT_NEAR(unreturned_per_lost({}, t, kWide), 1 / kPiecesBelow, 1e-9) << t;
}

// Whole beams on leaves as Lambert's law says: brightness 1.5·cosine, of which the share (t/1.5)² is below t.
TEST(UnreturnedBeams, AreThoseOnLeavesSeenEdgeOn) {
  for (const double t : {0.15, 0.3}) {
    const double dark = std::pow(t / 1.5, 2);
    const double above = (std::pow((t + kBandAboveWeakest) / 1.5, 2) - dark) / kBandAboveWeakest;
    EXPECT_NEAR(unreturned_per_lost({1, 0}, t, kNarrow), dark / (kPiecesBelow * above * t * t / 2), 0.03) << t;
  }
}

TEST(UnreturnedBeams, ThinBeamsOnLeavesOfOneBrightnessAllReturn) {
  EXPECT_EQ(unreturned_per_lost({}, 0.3, kNarrow), 1);  // nothing is lost, and nothing times one is hidden
}

/// The same by throwing beams.
double thrown(const LeafBrightness& leaves, double t, double widths) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> any;
  std::normal_distribution<double> normal;
  const double whole = std::max(0.0, 1 - M_PI * widths + M_PI / 2 * widths * widths);
  double taken = 0, hidden = 0, near = 0;
  constexpr int kBeams = 2'000'000;
  for (int i = 0; i < kBeams; ++i) {
    // Of what leaves take, `whole` is by beams of which they take all; the others count half of their number.
    const bool is_whole = any(rng) < whole / (whole + 2 * (1 - whole));
    const double part = is_whole ? 1 : any(rng), cosine = std::sqrt(any(rng));
    const double angle = (1 - leaves.angle_dependence * (1 - cosine)) / (1 - leaves.angle_dependence / 3);
    const double strength = part * angle * std::max(0.05, 1 + leaves.scatter * normal(rng));
    taken += part;
    if (strength < t) hidden += part;
    if (strength >= t && strength < t + kBandAboveWeakest) ++near;
  }
  return hidden / (kPiecesBelow * near / kBandAboveWeakest * t * t / 2);
}

TEST(UnreturnedBeams, AreThoseOfBeamsThrownAtLeaves) {
  struct Case {
    LeafBrightness leaves;
    double detection_share, widths;
  };
  for (const Case& c : {Case{{0.7, 0.26}, 0.36, 0.3}, Case{{1, 0.2}, 0.25, 0.2}, Case{{0.4, 0}, 0.15, 0.6}})
    EXPECT_NEAR(unreturned_per_lost(c.leaves, c.detection_share, c.widths),
                thrown(c.leaves, c.detection_share, c.widths), 0.03);
}

TEST(UnreturnedBeams, HideTheMoreTheMoreLeavesDiffer) {
  double before = 0;
  for (const LeafBrightness& leaves :
       {LeafBrightness{0, 0}, LeafBrightness{0.7, 0}, LeafBrightness{0.9, 0}, LeafBrightness{1, 0}}) {
    const double now = unreturned_per_lost(leaves, 0.3, 0.3);
    EXPECT_GT(now, before);
    EXPECT_GT(unreturned_per_lost({leaves.angle_dependence, 0.25}, 0.3, 0.3), now);
    before = now;
  }
}

}  // namespace
}  // namespace rayfield::density
