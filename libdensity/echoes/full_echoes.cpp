#include "libdensity/echoes/full_echoes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

// Chosen on 24 simulated scans and two of block_b (docs/beams-fits.md).
constexpr double kNarrowestM = 0.025;             // narrower beams are taken for such: rays are not so close
constexpr double kRingFrom = 0.8, kRingTo = 1.5;  // diameters of the beam from its axis: where others must have ended
constexpr double kInside = 1.0;                   // and how far out none may have ended elsewhere
constexpr int kSectors = 6;                       // of the ring, each with an echo
constexpr double kFlatM = 0.02;                   // rms of the echoes from their plane, ranges' noise included
constexpr double kOffPlaneM = 0.03;               // farther from it is elsewhere
constexpr double kStartM = 0.06;                  // along the beam: for the plane
constexpr float kNearbyM = 0.15F;                 // and what is looked at at all
constexpr float kSameDirection = 0.97F;           // cosine: 14°
constexpr std::size_t kLeastForPlane = 5;
constexpr std::size_t kRounds = 8;  // of which one after the other is looked at until enough are found
constexpr double kFlattestShare = 0.1, kSpreads = 1.4;
constexpr double kBrightest = 2;      // medians: what is brighter is no leaf
constexpr double kOfMedian = 1.2533;  // error of a median over that of a mean
constexpr double kFinest = 1e-3;
constexpr std::size_t kEnoughForSlope = 10;  // the errors of fewer are not known, either

/// Every other echo in the order of their places, every other two, and the odd ones of the one with the even ones of
/// the other: no two of these ways to divide have more than half of a half in common.
std::size_t halves_of(std::size_t number) {
  const std::size_t one = number & 1, two = number >> 1 & 1;
  return one | two << 1 | (one ^ two) << 2;
}

/// An echo near another one, seen along the other's beam.
struct Neighbour {
  double x, y, along;  ///< across the beam, and beyond the other one
  double distance;     ///< √(x² + y²), in diameters of the beam
  std::size_t halves;  ///< bit k: which one of the k-th way to divide
};

/// Least squares of along = a·x + b·y + c through neighbours and the echo itself.
class PlaneFit {
 public:
  void add(const Neighbour& n) {
    const Eigen::Vector3d row(n.x, n.y, 1);
    normal_ += row * row.transpose(), right_ += n.along * row, ++count_;
  }
  std::size_t count() const { return count_; }
  Eigen::Vector3d solve() const {
    Eigen::Matrix3d m = normal_;
    m.diagonal() += Eigen::Vector3d(1e-9, 1e-9, 1);  // the echo itself at (0, 0)
    return m.ldlt().solve(right_);
  }

 private:
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  std::size_t count_ = 0;
};

float cosine_of(const Eigen::Vector3d& plane) {
  return static_cast<float>(1 / std::sqrt(1 + plane.head<2>().squaredNorm()));
}

/// Against the beam; axes as those of PlaneFit.
Eigen::Vector3d normal_of(const Eigen::Vector3d& plane) {
  return Eigen::Vector3d(plane.x(), plane.y(), -1).normalized();
}

double off_plane(const Neighbour& n, const Eigen::Vector3d& plane) {
  return n.along - (plane.x() * n.x + plane.y() * n.y + plane.z());
}

/// Of the normal of a plane through all, a half's being off by twice its variance.
float normal_variance(std::span<const std::array<Eigen::Vector3d, 2>> halves) {
  double squares = 0;
  for (const auto& [one, other] : halves) squares += (normal_of(one) - normal_of(other)).squaredNorm();
  return static_cast<float>(squares / (8 * static_cast<double>(halves.size())));
}

/// Whether the neighbours make a full echo of the one amid them, its cosines and its normal. `axes`: of the neighbours'
/// coordinates, in columns.
bool is_full(std::span<const Neighbour> neighbours, const Eigen::Matrix3d& axes, FullEcho& out) {
  PlaneFit first_guess;
  for (const Neighbour& n : neighbours)
    if (std::abs(n.along) < kStartM) first_guess.add(n);
  if (first_guess.count() + 1 < kLeastForPlane) return false;
  const Eigen::Vector3d plane = first_guess.solve();
  if (std::abs(plane.z()) >= kFlatM) return false;
  unsigned sectors = 0;
  double squares = 0;
  std::size_t on_plane = 0;
  std::array<std::array<PlaneFit, 2>, FullEcho::kWays> halves;
  for (const Neighbour& n : neighbours) {
    const double off = off_plane(n, plane);
    if (std::abs(off) >= kOffPlaneM) {
      if (n.distance < kInside) return false;
      continue;
    }
    squares += off * off;
    for (std::size_t way = 0; way < halves.size(); ++way) halves[way][n.halves >> way & 1].add(n);
    ++on_plane;
    const double turn = std::atan2(n.y, n.x) / (2 * std::numbers::pi) + 0.5;
    if (n.distance > kRingFrom) sectors |= 1u << (floor_int(turn * kSectors) % kSectors);
  }
  if (sectors != (1u << kSectors) - 1 || squares >= kFlatM * kFlatM * static_cast<double>(on_plane)) return false;
  for (const auto& [one, other] : halves)
    if (std::min(one.count(), other.count()) + 1 < kLeastForPlane) return false;
  out.cosine = cosine_of(plane), out.spread_m = static_cast<float>(std::sqrt(squares / static_cast<double>(on_plane)));
  std::array<std::array<Eigen::Vector3d, 2>, FullEcho::kWays> planes;
  for (std::size_t way = 0; way < halves.size(); ++way) {
    planes[way] = {halves[way][0].solve(), halves[way][1].solve()};
    out.half_cosine[way] = {cosine_of(planes[way][0]), cosine_of(planes[way][1])};
  }
  out.ray_up = static_cast<float>(-axes(2, 2)), out.normal_up = static_cast<float>((axes * normal_of(plane)).z());
  out.normal_variance = normal_variance(planes);
  return true;
}

class FullEchoFinder {
 public:
  explicit FullEchoFinder(const EchoColumns& columns) : columns_(columns) {}

  /// The echo `i`, if it is a full one.
  std::optional<FullEcho> at(std::size_t i) {
    const std::span<const LeafEcho> echoes = columns_.echoes();
    const LeafEcho& echo = echoes[i];
    const Eigen::Vector3f across = echo.direction.unitOrthogonal(), third = echo.direction.cross(across);
    const double width_m = std::max(kNarrowestM, static_cast<double>(echo.width_m));
    const double ring_m = kRingTo * width_m;
    const float farthest_square = kBoxSlack * static_cast<float>(ring_m * ring_m);
    neighbours_.clear();
    const auto visit = [&](std::size_t j) {
      const Eigen::Vector3f to = echoes[j].position - echo.position;
      const float along = to.dot(echo.direction);
      if (j == i || std::abs(along) >= kNearbyM || to.squaredNorm() - along * along > farthest_square ||
          echoes[j].direction.dot(echo.direction) <= kSameDirection)
        return;
      const auto x = static_cast<double>(to.dot(across)), y = static_cast<double>(to.dot(third));
      const double distance = std::hypot(x, y) / width_m;
      if (distance < kRingTo) neighbours_.push_back({x, y, static_cast<double>(along), distance, halves_of(j)});
    };
    columns_.for_near(echo.position, box_around_beam(echo.direction, kNearbyM, static_cast<float>(ring_m)), visit);
    FullEcho full{echo.intensity};
    Eigen::Matrix3d axes;
    axes << across.cast<double>(), third.cast<double>(), echo.direction.cast<double>();
    return is_full(neighbours_, axes, full) ? std::optional(full) : std::nullopt;
  }

 private:
  const EchoColumns& columns_;
  std::vector<Neighbour> neighbours_;
};

/// The value that a share of the values do not reach.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + floor_int(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// Mean of values, those above `most` as if they were that, and its standard error.
struct Level {
  double mean = 0, error = 0;
};

Level level_of(std::span<const double> values, double most) {
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) sum += std::min(v, most), squares += std::min(v, most) * std::min(v, most);
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

/// Standard deviation of full echoes, those above `most` as if they were that, from a line through their mean, over it.
double scatter_about(std::span<const FullEcho> echoes, double mean, double per_cosine, double mean_cosine,
                     double most) {
  double squares = 0;
  for (const FullEcho& e : echoes) {
    const double line = mean + per_cosine * (static_cast<double>(e.cosine) - mean_cosine);
    const double off = std::min<double>(e.intensity, most) - line;
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(echoes.size())) / mean;
}

/// Differences between the echoes of which `instrument` is above its median and the others.
struct Contrast {
  double intensity = 0, cosine = 0;
  Contrast& operator+=(const Contrast& other) {
    intensity += other.intensity, cosine += other.cosine;
    return *this;
  }
};

/// `instrument`: one of the halves of a way to divide; the cosine is the other's.
Contrast contrast(std::span<const FullEcho> echoes, std::size_t way, std::size_t instrument) {
  std::vector<double> values;
  for (const FullEcho& e : echoes) values.push_back(static_cast<double>(e.half_cosine[way][instrument]));
  const double middle = median(values);
  std::array<std::vector<double>, 2> intensity;
  std::array<double, 2> sum{};
  for (const FullEcho& e : echoes) {
    const std::size_t side = static_cast<double>(e.half_cosine[way][instrument]) > middle ? 1 : 0;
    intensity[side].push_back(e.intensity), sum[side] += static_cast<double>(e.half_cosine[way][1 - instrument]);
  }
  if (intensity[0].empty() || intensity[1].empty()) return {};
  const auto mean = [&](std::size_t side) { return sum[side] / static_cast<double>(intensity[side].size()); };
  return {median(intensity[1]) - median(intensity[0]), mean(1) - mean(0)};
}

}  // namespace

std::vector<FullEcho> find_full_echoes(const EchoColumns& columns, std::size_t enough) {
  std::vector<FullEcho> out;
  FullEchoFinder finder(columns);
  for (std::size_t first = 0; first < kRounds && out.size() < enough; ++first)
    for (std::size_t i = first; i < columns.echoes().size(); i += kRounds)
      if (const std::optional<FullEcho> full = finder.at(i)) out.push_back(*full);
  return out;
}

std::vector<FullEcho> flattest_of(std::span<const FullEcho> echoes) {
  std::vector<double> spreads;
  for (const FullEcho& e : echoes) spreads.push_back(static_cast<double>(e.spread_m));
  const double most_m = kSpreads * quantile(std::move(spreads), kFlattestShare);
  std::vector<FullEcho> out;
  std::copy_if(echoes.begin(), echoes.end(), std::back_inserter(out),
               [most_m](const FullEcho& e) { return static_cast<double>(e.spread_m) <= most_m; });
  return out;
}

FullEchoStrength full_echo_strength(std::span<const FullEcho> all, const AngleDependence& prior) {
  const std::vector<FullEcho> echoes = flattest_of(all);
  FullEchoStrength out;
  out.count = echoes.size(), out.slope = prior.slope, out.slope_error = prior.error;
  if (echoes.empty()) return out;
  std::vector<double> values;
  double cosine = 0;
  for (const FullEcho& e : echoes) values.push_back(e.intensity), cosine += static_cast<double>(e.cosine);
  cosine /= static_cast<double>(echoes.size());
  const double middle = median(values);
  if (!(middle > 0)) return out;
  const Level level = level_of(values, kBrightest * middle);
  Contrast sum;
  for (std::size_t way = 0; way < FullEcho::kWays; ++way)
    for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) sum += contrast(echoes, way, half);
  const double span = sum.cosine / (2 * FullEcho::kWays);
  if (echoes.size() >= kEnoughForSlope && span > 0.01) {
    const double measured = sum.intensity / sum.cosine / middle;
    // Of the difference of two halves' medians.
    const double error = std::max(kFinest, 2 * kOfMedian * level.error / level.mean / span);
    const double weight = 1 / (error * error), prior_weight = 1 / (prior.error * prior.error);
    out.slope = (weight * measured + prior_weight * prior.slope) / (weight + prior_weight);
    out.slope_error = 1 / std::sqrt(weight + prior_weight);
  }
  const double step = kSphericalMeanCosine - cosine;
  out.intensity = level.mean * (1 + out.slope * step), out.per_cosine = level.mean * out.slope;
  out.error = std::hypot(level.error / level.mean, out.slope_error * step);
  out.angle_dependence = std::clamp(out.slope / std::max(kFinest, 1 + out.slope * (1 - cosine)), 0.0, 1.0);
  out.scatter = scatter_about(echoes, level.mean, out.per_cosine, cosine, kBrightest * middle);
  return out;
}

}  // namespace rayfield::density
