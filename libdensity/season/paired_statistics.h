#pragma once

#include <span>

#include "rayfield/core/season_products.h"

/// season: what changes from date to date, computed from the products of a block.
namespace rayfield::density {

/// Over the pairs of which both values are finite. `a` and `b` have equal lengths. What is unknown is NaN: means
/// without a pair, lines and r² with fewer than two pairs or without spread.
///   RRMSE = √(Σ(b−a)²/n) / (Σ(a+b)/2n)                                        (paper, "Robustness Experiment")
///   least squares: slope = S_ab/S_aa, r² = S_ab²/(S_aa·S_bb), S_xy = Σ(x−x̄)(y−ȳ)
///   orthogonal: slope = (S_bb − S_aa + √((S_bb − S_aa)² + 4·S_ab²)) / 2·S_ab   (Deming, equal errors on both dates)
/// The least-squares line is what the paper draws. Errors of `a` flatten it; the orthogonal one has none of that where
/// both dates are equally uncertain.
PairedStatistics paired_statistics(std::span<const double> a, std::span<const double> b);

}  // namespace rayfield::density
