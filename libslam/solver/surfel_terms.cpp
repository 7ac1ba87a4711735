#include "libslam/solver/surfel_terms.h"

namespace rayfield::slam {

void SurfelSums::add(const SurfelSums& other) {
  matches += other.matches, inliers += other.inliers;
  weights += other.weights, squares += other.squares;
  information += other.information;
}

SurfelSums add_surfel_terms(const ResidualFrame& frame, std::span<const Surfel> surfels,
                            std::span<const SurfelMatch> matches, const SurfelWeights& weights, BlockSystem& system,
                            BlockSystem& coupling) {
  const double slack2 = weights.slack_m * weights.slack_m;
  SurfelSums sums;
  sums.matches = matches.size();
  for (const SurfelMatch& m : matches) {
    const Surfel &a = surfels[m.first], &b = surfels[m.second];
    const PairResidual r = surfel_residual(frame, a, b);
    const double layers = static_cast<double>(a.variance_m2) + static_cast<double>(b.variance_m2);
    const double variance = weights.sigma_m * weights.sigma_m + weights.layer_share * layers;
    const double square = r.error() * r.error();
    const double scale2 = weights.cauchy * weights.cauchy * variance + slack2;
    const double weight = weights.share / ((variance + slack2) * (1 + square / scale2));
    system.add(r.first, weight);
    system.add(r.second, weight);
    coupling.add_coupling(r.first, r.second, weight);
    sums.weights += weight, sums.squares += weight * square;
    sums.inliers += square < 9 * variance;
    sums.information += kIndependentShare / weights.share * weight * r.normal * r.normal.transpose();
  }
  return sums;
}

}  // namespace rayfield::slam
