#include "libdensity/season/paired_statistics.h"

#include <cmath>
#include <limits>

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Σ(x−x̄)², Σ(y−ȳ)², Σ(x−x̄)(y−ȳ)
struct Spread {
  double aa = 0, bb = 0, ab = 0;
};

void fit_lines(const Spread& s, PairedStatistics& out) {
  if (s.aa > 0) {
    out.slope = s.ab / s.aa;
    out.intercept = out.mean_b - out.slope * out.mean_a;
    if (s.bb > 0) out.r_squared = s.ab * s.ab / (s.aa * s.bb);
  }
  if (s.ab != 0) {
    const double difference = s.bb - s.aa;
    out.orthogonal_slope = (difference + std::hypot(difference, 2 * s.ab)) / (2 * s.ab);
    out.orthogonal_intercept = out.mean_b - out.orthogonal_slope * out.mean_a;
  }
}

}  // namespace

PairedStatistics paired_statistics(std::span<const double> a, std::span<const double> b) {
  PairedStatistics out;
  double sum_a = 0, sum_b = 0, squares = 0;
  const auto for_pairs = [&](auto use) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::isfinite(a[i]) && std::isfinite(b[i])) use(a[i], b[i]);
  };
  for_pairs([&](double x, double y) {
    sum_a += x, sum_b += y, squares += (y - x) * (y - x);
    ++out.count;
  });
  out.mean_a = out.mean_b = out.rmse = out.rrmse = kNaN;
  out.slope = out.intercept = out.orthogonal_slope = out.orthogonal_intercept = out.r_squared = kNaN;
  if (out.count == 0) return out;
  const double n = static_cast<double>(out.count), mean = (sum_a + sum_b) / (2 * n);
  out.mean_a = sum_a / n, out.mean_b = sum_b / n;
  out.rmse = std::sqrt(squares / n);
  if (mean > 0) out.rrmse = out.rmse / mean;
  Spread spread;
  for_pairs([&](double x, double y) {
    spread.aa += (x - out.mean_a) * (x - out.mean_a);
    spread.bb += (y - out.mean_b) * (y - out.mean_b);
    spread.ab += (x - out.mean_a) * (y - out.mean_b);
  });
  if (out.count >= 2) fit_lines(spread, out);
  return out;
}

}  // namespace rayfield::density
