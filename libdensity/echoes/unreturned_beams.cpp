#include "libdensity/echoes/unreturned_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rayfield::density {
namespace {

constexpr int kCosines = 256;
constexpr double kLeastScattered = 0.05;  // of the mean: scatter makes no leaf darker

/// Nodes, in standard deviations, and weights of a normal distribution (Gauss and Hermite).
struct Node {
  double deviation, weight;
};
constexpr std::array<Node, 5> kNormal{{{-2.8569700138728056, 0.011257411327720693},
                                       {-1.3556261799742659, 0.22207592200561263},
                                       {0, 0.5333333333333333},
                                       {1.3556261799742659, 0.22207592200561263},
                                       {2.8569700138728056, 0.011257411327720693}}};

/// Part of the beams that falls wholly on a leaf, of what square leaves turned at random take.
double wholly_on_leaf(double widths_of_leaf) {
  constexpr double kPi = std::numbers::pi;
  if (widths_of_leaf >= 1) return 0;
  return std::max(0.0, 1 - kPi * widths_of_leaf + kPi / 2 * widths_of_leaf * widths_of_leaf);
}

/// Brightness of leaves, 1 in the mean over the hits, by the cosine of the angle of incidence.
class Brightness {
 public:
  explicit Brightness(double angle_dependence)
      : dependence_(std::clamp(angle_dependence, 0.0, 1.0)), mean_(1 - dependence_ / 3) {}
  double at(double cosine) const { return (1 - dependence_ * (1 - cosine)) / mean_; }
  /// Share of the hits on darker ones: hits go with the cosine, so that cos² is spread evenly.
  double darker_than(double bright) const {
    if (!(dependence_ > 0)) return bright > 1 ? 1 : 0;
    const double cosine = std::clamp(1 - (1 - bright * mean_) / dependence_, 0.0, 1.0);
    return cosine * cosine;
  }

 private:
  double dependence_, mean_;
};

}  // namespace

double unreturned_per_lost(const LeafBrightness& leaves, double detection_share, double widths_of_leaf) {
  const double whole = wholly_on_leaf(widths_of_leaf), cut = 1 - whole;
  const double t = detection_share, above_t = t + kBandAboveWeakest;
  const Brightness brightness(leaves.angle_dependence);
  double unreturned = 0, echoes_above = 0;  // the latter per unit of strength
  for (const Node& node : kNormal) {
    const double scattered = std::max(kLeastScattered, 1 + leaves.scatter * node.deviation);
    // Wholly on a leaf: what is darker than t.
    const double dark = brightness.darker_than(t / scattered);
    double hidden = whole * dark, in_band = whole * (brightness.darker_than(above_t / scattered) - dark);
    // Cut: any part c of the beam alike, which returns where c·bright ≥ t; taken in the mean: ½.
    for (int i = 0; i < kCosines; ++i) {
      const double bright = scattered * brightness.at(std::sqrt((i + 0.5) / kCosines));
      const double from = std::min(1.0, t / bright), to = std::min(1.0, above_t / bright);
      hidden += cut / kCosines * from * from, in_band += cut / kCosines * 2 * (to - from);
    }
    unreturned += node.weight * hidden, echoes_above += node.weight * in_band / kBandAboveWeakest;
  }
  const double lost = kPiecesBelow * echoes_above * t * t / 2;
  return lost > 0 ? unreturned / lost : 1;
}

}  // namespace rayfield::density
