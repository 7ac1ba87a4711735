#include "libdensity/echoes/leaf_normals.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace rayfield::density {
namespace {

constexpr std::size_t kEnough = 10, kMost = 10000;  // full echoes; of more, evenly so many
constexpr int kDegrees = 21;                        // of Legendre's polynomials, the even ones: γ is even
constexpr double kLeastNoise = 0.08;                // rad: finer than these polynomials are not
constexpr int kSteps = 400;                         // of n_z from 0 to 1
constexpr double kBelief = 0.7;                     // ln χ = 0 ± this
constexpr int kFamilies = 3, kEllipsoids = 31;
constexpr double kFirstLnRatio = -1, kLnRatioStep = 0.1;  // of the ellipsoids
constexpr double kLeastLikelihood = 1e-4;                 // series of sharp shapes swing about 0
// Beliefs about the other families' numbers: a, b = 0 ± 4; ln of those of the beta distribution as of leaves turned at
// random ± 0.7.
constexpr double kExponentBelief = 4, kBetaMean = 0.66, kBetaNu = 0.1, kBetaBelief = 0.7;
constexpr std::size_t kLeastRuns = 16, kMostRuns = 64, kEchoesOfRun = 20;

using Steps = Eigen::Array<double, kSteps, 1>;
using Polynomials = Eigen::Array<double, kDegrees, 1>;  // P_0, P_2, P_4, …

double up_at(int step) { return (step + 0.5) / kSteps; }

Steps ups() { return Steps::LinSpaced(up_at(0), up_at(kSteps - 1)); }

Polynomials polynomials(double x) {
  Polynomials out;
  double before = 1, here = x;
  out(0) = 1;
  for (int l = 1; l < 2 * kDegrees - 2; ++l) {
    const double next = ((2 * l + 1) * x * here - l * before) / (l + 1);
    before = here, here = next;
    if (l % 2 == 1) out((l + 1) / 2) = here;
  }
  return out;
}

Steps ellipsoid(double ln_ratio) {
  const double ratio = std::exp(ln_ratio);
  return ups().unaryExpr([&](double up) { return ellipsoid_normals(ratio, up); });
}

/// Area that leaves of these normals show to level rays, over all of it.
double level_projection(const Steps& density) {
  return (density * (1 - ups().square()).sqrt()).sum() * 2 / std::numbers::pi / density.sum();
}

/// Of the ellipsoid as large to level rays.
double ln_ratio_of(const Steps& density) {
  const double projection = level_projection(density);
  double low = -2, high = 3;
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    (level_projection(ellipsoid(middle)) > projection ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Shapes that γ may have.
struct Shapes {
  Eigen::Array<double, Eigen::Dynamic, kDegrees> series;  ///< of γ over its mean
  Eigen::ArrayXd ln_ratio, ln_belief;
};

class ShapeList {
 public:
  /// `ln_belief`: within the family.
  void add(int family, const Steps& density, double ln_belief) {
    densities_.push_back(density / density.mean());
    families_.push_back(family), beliefs_.push_back(std::exp(ln_belief));
    sums_[static_cast<std::size_t>(family)] += beliefs_.back();
  }
  Shapes shapes() const {
    const auto n = static_cast<Eigen::Index>(densities_.size());
    Eigen::Array<double, kSteps, kDegrees> at;
    for (int i = 0; i < kSteps; ++i) at.row(i) = polynomials(up_at(i)).transpose() / kSteps;
    Shapes out{{n, kDegrees}, Eigen::ArrayXd(n), Eigen::ArrayXd(n)};
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      out.series.row(k) = (densities_[i].matrix().transpose() * at.matrix()).array();
      out.ln_ratio(k) = ln_ratio_of(densities_[i]);
      const double off = out.ln_ratio(k) / kBelief;
      out.ln_belief(k) = std::log(beliefs_[i] / sums_[static_cast<std::size_t>(families_[i])]) - off * off / 2;
    }
    for (int k = 0; k < kDegrees; ++k) out.series.col(k) *= 4 * k + 1;
    return out;
  }

 private:
  std::vector<Steps> densities_;
  std::vector<int> families_;
  std::vector<double> beliefs_;
  std::array<double, kFamilies> sums_{};
};

double ln_normal(double value, double mean, double error) {
  const double off = (value - mean) / error;
  return -off * off / 2;
}

Shapes make_shapes() {
  ShapeList list;
  for (int i = 0; i < kEllipsoids; ++i) list.add(0, ellipsoid(kFirstLnRatio + i * kLnRatioStep), 0);
  const Steps up = ups(), squares = up.square();
  for (int a = -4; a <= 14; ++a)
    for (int b = -12; b <= 8; ++b) {
      const Steps exponent = a * squares + b * squares.square();
      list.add(1, (exponent - exponent.maxCoeff()).exp(),
               ln_normal(a, 0, kExponentBelief) + ln_normal(b, 0, kExponentBelief));
    }
  const Steps inclination = 2 / std::numbers::pi * up.acos();  // 0 … 1
  for (int m = 0; m < 16; ++m)
    for (int n = 0; n < 13; ++n) {
      const double ln_mu = -1.2 + 0.2 * m, ln_nu = -0.8 + 0.2 * n;
      list.add(2,
               inclination.pow(std::exp(ln_mu) - 1) * (1 - inclination).pow(std::exp(ln_nu) - 1) / (1 - squares).sqrt(),
               ln_normal(ln_mu, kBetaMean, kBetaBelief) + ln_normal(ln_nu, kBetaNu, kBetaBelief));
    }
  return list.shapes();
}

const Shapes& shapes() {
  static const Shapes kShapes = make_shapes();
  return kShapes;
}

/// ln of the likelihood of a normal, by shape. In the mean over a ring of the angle c about a ray, P_l is P_l(cos c)
/// times P_l of the ray (addition theorem of spherical harmonics).
Eigen::ArrayXd ln_likelihood(const FullEcho& e, const Eigen::ArrayXXd& series) {
  const Polynomials here = polynomials(static_cast<double>(e.normal_up));
  const Polynomials ring = polynomials(static_cast<double>(e.cosine)) * polynomials(static_cast<double>(e.ray_up));
  const Eigen::ArrayXd at = (series.matrix() * here.matrix()).array(), mean = (series.matrix() * ring.matrix()).array();
  return at.max(kLeastLikelihood).log() - mean.max(kLeastLikelihood).log();
}

/// Errors of normals turn them evenly in all directions: the l-th term fades by exp(−l·(l + 1)·σ²/2).
Eigen::ArrayXXd smoothed_series(std::span<const FullEcho> echoes) {
  double squares = 0;
  for (const FullEcho& e : echoes) squares += static_cast<double>(e.normal_variance);
  const double variance = std::max(kLeastNoise * kLeastNoise, squares / static_cast<double>(echoes.size()));
  Eigen::ArrayXXd series = shapes().series;
  for (int k = 0; k < kDegrees; ++k) series.col(k) *= std::exp(-k * (2 * k + 1) * variance);
  return series;
}

std::vector<FullEcho> evenly_from(const std::vector<FullEcho>& echoes) {
  if (echoes.size() <= kMost) return echoes;
  std::vector<FullEcho> out;
  for (std::size_t i = 0; i < kMost; ++i) out.push_back(echoes[i * echoes.size() / kMost]);
  return out;
}

/// How much more the sums over runs of equal length scatter than those of values that do not depend on each other.
double excess_of_runs(std::span<const double> values) {
  const std::size_t runs = std::clamp(values.size() / kEchoesOfRun, kLeastRuns, kMostRuns);
  const auto n = static_cast<double>(values.size());
  double mean = 0, squares = 0, of_runs = 0;
  for (const double v : values) mean += v / n;
  std::vector<double> sums(runs);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double off = values[i] - mean;
    squares += off * off, sums[i * runs / values.size()] += off;
  }
  for (const double sum : sums) of_runs += sum * sum;
  return squares > 0 ? std::max(1.0, of_runs / squares) : 1;
}

}  // namespace

std::optional<LnRatio> fit_leaf_normals(std::span<const FullEcho> all) {
  const std::vector<FullEcho> echoes = evenly_from(flattest_of(all));
  if (echoes.size() < kEnough) return std::nullopt;
  const Eigen::ArrayXXd series = smoothed_series(echoes);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(series.rows());
  std::vector<Eigen::Array<double, kEllipsoids, 1>> of_ellipsoids;
  for (const FullEcho& e : echoes) {
    const Eigen::ArrayXd ln = ln_likelihood(e, series);
    sum += ln, of_ellipsoids.emplace_back(ln.head<kEllipsoids>());
  }
  Eigen::Index best = 0;
  sum.head<kEllipsoids>().maxCoeff(&best);
  best = std::clamp<Eigen::Index>(best, 1, kEllipsoids - 2);
  std::vector<double> slopes;  // by the ratio
  for (const auto& ln : of_ellipsoids) slopes.push_back(ln(best + 1) - ln(best - 1));
  const Eigen::ArrayXd ln = shapes().ln_belief + sum / excess_of_runs(slopes);
  Eigen::ArrayXd weights = (ln - ln.maxCoeff()).exp();
  weights /= weights.sum();
  const double mean = (weights * shapes().ln_ratio).sum();
  return LnRatio{mean, std::sqrt((weights * (shapes().ln_ratio - mean).square()).sum())};
}

}  // namespace rayfield::density
