#include "libdensity/echoes/leaf_size.h"
#include "libdensity/echoes/leaf_angle.h"
#include "libdensity/tiles/rounding.h"
#include "libdensity/tiles/uniform.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rayfield::density {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSamples = 20000;               // standard error of the two averages below about 0.5 %
constexpr std::uint64_t kEnoughPairs = 2000;  // standard error of the share of same-leaf pairs about 1 %
constexpr double kNearestM = 0.01;            // nearer both beams are the same surface whatever its size
constexpr double kNoiseSideM = 0.08;          // of leaves: matters little for how ranges scatter
constexpr double kUsualNoiseM = 0.0175;       // up to here the usual windows are right
constexpr double kWindowNoises = 4, kWidestWindowM = 0.1;
constexpr double kEnough = 1000;  // pairs, for the noise:
constexpr auto kFirstNoiseBin = static_cast<std::size_t>(kNearestM / LeafSizePairs::kStepM);
constexpr auto kLastNoiseBin = static_cast<std::size_t>(LeafSizePairs::kCloseM / LeafSizePairs::kStepM);
constexpr double kCoreM = 0.02, kAllOfLeafM = 0.10;  // |Δ| of most pairs of one leaf, and of all
constexpr double kLeastNoiseM = 0.001, kMostNoiseM = 0.08;
constexpr double kMinSideM = 0.02, kMaxSideM = 0.25;
constexpr double kTiltedDistanceM = 0.025, kTiltedSideM = 0.08;  // for apparent_side()

double gaussian(Uniform& uniform) { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * kPi * uniform()); }

Eigen::Vector3d direction(Uniform& uniform) {
  const double z = 2 * uniform() - 1, azimuth = 2 * kPi * uniform(), s = std::sqrt(1 - z * z);
  return {s * std::cos(azimuth), s * std::sin(azimuth), z};
}

/// Where a parallel ray at unit lateral distance meets the plane of a leaf that a ray along z has hit: offset in
/// the leaf's own axes and along the ray, and the noise of the two ranges in units of their standard deviation.
struct PlaneSample {
  double u, v, along, noise;
  double cosine;  // of the angle between the ray and the leaf's normal
};

std::vector<PlaneSample> plane_samples() {
  std::vector<PlaneSample> out;
  out.reserve(kSamples);
  Uniform uniform(20190211);
  for (int i = 0; i < kSamples; ++i) {
    // A ray hits leaves in proportion to |cos| of the angle to their normal: cos = √uniform.
    const double c = std::sqrt(uniform()), s = std::sqrt(1 - c * c);
    const double azimuth = 2 * kPi * uniform(), turn = 2 * kPi * uniform();
    const double x = std::cos(azimuth), y = std::sin(azimuth);
    const double along = -x * s / c;
    const double a = x * c - along * s;  // in the plane, down the slope
    out.push_back({a * std::cos(turn) + y * std::sin(turn), -a * std::sin(turn) + y * std::cos(turn), along,
                   std::sqrt(2.0) * gaussian(uniform), c});
  }
  return out;
}

const std::vector<PlaneSample>& shared_samples() {
  static const std::vector<PlaneSample> kPlaneSamples = plane_samples();
  return kPlaneSamples;
}

double difference_of(const PlaneSample& p, double r, const PairWindows& windows) {
  return std::abs(r * p.along + windows.range_noise_m * p.noise);
}

/// The first ray hits anywhere on the square: share of places from which the offset stays on it.
double share_on_leaf(const PlaneSample& p, double r, double side_m) {
  return std::max(0.0, 1 - std::abs(r * p.u) / side_m) * std::max(0.0, 1 - std::abs(r * p.v) / side_m);
}

/// Probabilities that the parallel ray ends on the same leaf: with a difference of range inside ±w, and in each of
/// the windows −2w…−w and w…2w (equal by symmetry).
struct SameLeaf {
  double centre = 0, side = 0;
};

SameLeaf same_leaf(double r, double side_m, const PairWindows& windows) {
  const std::vector<PlaneSample>& samples = shared_samples();
  SameLeaf out;
  for (const PlaneSample& p : samples) {
    const double difference = difference_of(p, r, windows);
    if (difference >= 2 * windows.window_m) continue;
    (difference < windows.window_m ? out.centre : out.side) += share_on_leaf(p, r, side_m);
  }
  out.centre /= static_cast<double>(samples.size());
  out.side /= 2 * static_cast<double>(samples.size());
  return out;
}

/// How many more leaves are turned like that than of leaves turned at random, by |cosine| of the inclination.
class RelativeDensity {
 public:
  explicit RelativeDensity(const LeafAngles& angles) {
    for (std::size_t i = 0; i < kCells; ++i) {
      const double cosine = (static_cast<double>(i) + 0.5) / kCells, sine = std::sqrt(1 - cosine * cosine);
      cells_[i] = leaf_inclination_density(angles, std::acos(cosine)) / sine;
    }
  }
  /// In the mean over the directions in which a normal at that cosine to a ray of that elevation may point.
  double of_normals(double cosine_to_ray, double sine_of_ray) const {
    constexpr int kTurns = 16;
    const double across = std::sqrt((1 - cosine_to_ray * cosine_to_ray) * (1 - sine_of_ray * sine_of_ray));
    double sum = 0;
    for (int k = 0; k < kTurns; ++k) {
      const double up = sine_of_ray * cosine_to_ray + across * std::cos(2 * kPi * (k + 0.5) / kTurns);
      sum += cells_[std::min(kCells - 1, static_cast<std::size_t>(std::abs(up) * kCells))];
    }
    return sum / kTurns;
  }

 private:
  static constexpr std::size_t kCells = 64;
  std::array<double, kCells> cells_{};
};

/// Probability that a pair is of one leaf in the usual window, as same_leaf(), with leaves turned somehow.
double same_tilted_leaf(const RelativeDensity& density, double sine_of_ray) {
  double same = 0, all = 0;
  for (const PlaneSample& p : shared_samples()) {
    const double weight = density.of_normals(p.cosine, sine_of_ray);
    all += weight;
    if (difference_of(p, kTiltedDistanceM, kUsualWindows) < kUsualWindows.window_m)
      same += weight * share_on_leaf(p, kTiltedDistanceM, kTiltedSideM);
  }
  return same / all;
}

/// Number of rays that end with |Δ| up to a distance.
double ended_within(const LeafSizePairs::Depths& ends, double delta_m) {
  constexpr std::size_t kMiddle = LeafSizePairs::kDepths / 2;
  const auto steps = static_cast<std::size_t>(std::lround(delta_m / LeafSizePairs::kDepthStepM));
  double sum = 0;
  for (std::size_t i = kMiddle - steps; i < kMiddle + steps; ++i) sum += static_cast<double>(ends[i]);
  return sum;
}

/// Counts at one distance as shares of the rays that get that far.
struct Observed {
  double r, weight;              ///< weight: rays that arrive at the central window
  double front, centre, behind;  ///< share that ends in each window, of those that enter it
};

std::vector<Observed> observe(const PairCounts& pairs, double from_m, double to_m) {
  std::vector<Observed> out;
  for (int b = 0; b < LeafSizePairs::kBins; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const double r = (b + 0.5) * LeafSizePairs::kStepM;
    const auto near = static_cast<double>(pairs.near[i]), front = static_cast<double>(pairs.front[i]);
    const auto same = static_cast<double>(pairs.same[i]), behind = static_cast<double>(pairs.behind[i]);
    const double arrive = near - front, left = arrive - same;
    if (r < from_m || r > to_m || near < 50 || arrive <= 0) continue;
    out.push_back({r, arrive, front / near, same / arrive, left > 0 ? behind / left : 0});
  }
  return out;
}

double total_weight(const std::vector<Observed>& observed) {
  double sum = 0;
  for (const Observed& o : observed) sum += o.weight;
  return sum;
}

/// How much more often rays end at the same depth than leaves of that size, and others at the hazards seen in front
/// and behind, make them. The outer windows hold some of the same leaf too, which is taken out of the hazards.
double excess_at_depth(const Observed& o, const SameLeaf& q) {
  const double survive_front = (1 - o.front) / (1 - q.side);
  const double centre = q.centre / (1 - q.side);
  const double behind = std::min(0.99, q.side / std::max(0.01, 1 - q.side - q.centre));
  const double survive_behind = std::min(1.0, (1 - o.behind) / (1 - behind));
  return o.centre - (1 - (1 - centre) * std::min(1.0, survive_front) * survive_behind);
}

/// Of the steps of a ray, those at which it may be nearer to 0 than `reach_m` on every axis; a few more at either end.
std::pair<int, int> steps_within(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, double reach_m, double dt,
                                 int steps) {
  double begin = 0, end = steps;
  for (int k = 0; k < 3; ++k) {
    const double per_step = dt * ray[k];
    if (per_step == 0) continue;
    const double one = (-reach_m - from[k]) / per_step, other = (reach_m - from[k]) / per_step;
    begin = std::max(begin, std::min(one, other)), end = std::min(end, std::max(one, other));
  }
  constexpr double kSlack = 2;  // for the half step and what rounding does
  return {floor_int(std::max(0.0, begin - kSlack)), std::min(steps, ceil_int(std::max(0.0, end + kSlack)))};
}

}  // namespace

double same_leaf_probability(double distance_m, double side_m, const PairWindows& windows) {
  return same_leaf(distance_m, side_m, windows).centre;
}

double range_noise_of(const LeafSizePairs& pairs) {
  LeafSizePairs::Depths ends{};
  std::vector<std::pair<double, double>> distances;  // of rays, and how many ended at all depths
  double near = 0, all = 0;
  for (std::size_t bin = kFirstNoiseBin; bin < kLastNoiseBin && !(all > kEnough); ++bin) {
    for (std::size_t i = 0; i < ends.size(); ++i) ends[i] += pairs.ends[bin][i];
    const double of_leaf = ended_within(ends, kAllOfLeafM);
    const double others_per_m =
        (ended_within(ends, LeafSizePairs::kReachM) - of_leaf) / (LeafSizePairs::kReachM - kAllOfLeafM);
    near = ended_within(ends, kCoreM) - others_per_m * kCoreM, all = of_leaf - others_per_m * kAllOfLeafM;
    distances.emplace_back((static_cast<double>(bin) + 0.5) * LeafSizePairs::kStepM,
                           ended_within(pairs.ends[bin], LeafSizePairs::kReachM));
  }
  if (!(all > kEnough)) return 0;
  const auto share_within = [&](double noise_m) {
    double within = 0, of = 0;
    for (const auto& [distance_m, weight] : distances) {
      within += weight * same_leaf(distance_m, kNoiseSideM, {kCoreM, noise_m}).centre;
      of += weight * same_leaf(distance_m, kNoiseSideM, {kAllOfLeafM, noise_m}).centre;
    }
    return within / of;
  };
  double low = kLeastNoiseM, high = kMostNoiseM;
  for (int step = 0; step < 20; ++step) {
    const double middle = std::sqrt(low * high);
    (share_within(middle) > near / all ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

PairWindows windows_of(const LeafSizePairs& pairs) {
  const double noise_m = range_noise_of(pairs);
  if (noise_m <= kUsualNoiseM) return {};
  const double steps = std::round(kWindowNoises * noise_m / LeafSizePairs::kDepthStepM);
  return {std::min(kWidestWindowM, steps * LeafSizePairs::kDepthStepM), noise_m};
}

LeafSize estimate_leaf_size(const PairCounts& counts, const PairWindows& windows) {
  LeafSize out;
  // Close pairs tell most and are least disturbed by the arrangement of the leaves; wide ones are the way out for
  // lidars with coarse steps.
  std::vector<Observed> observed = observe(counts, kNearestM, windows.farthest_m);
  if (total_weight(observed) < kEnoughPairs) observed = observe(counts, kNearestM, 0.08);
  out.pairs = static_cast<std::uint64_t>(total_weight(observed));
  if (out.pairs < kEnoughPairs) return out;
  double low = kMinSideM, high = kMaxSideM;
  for (int step = 0; step < 30; ++step) {
    const double side = std::sqrt(low * high);
    double excess = 0;
    // A share f of hits on canes and wires takes f·q from q ≈ 1 − 4r/(π·side): its pull on the side, f·q/(dq/dside),
    // goes with 1/r. Distances weigh with r², as if that were their error.
    for (const Observed& o : observed)
      excess += o.weight * o.r * o.r * excess_at_depth(o, same_leaf(o.r, side, windows));
    (excess > 0 ? low : high) = side;
  }
  out.area_m2 = std::min(low * high, LeafSize::kLargestM2);
  out.measured = true;
  return out;
}

double apparent_side(const LeafAngles& angles, std::span<const double> sines, std::span<const double> hits) {
  if (angles.type == LeafAngleType::spherical || angles.type == LeafAngleType::measured) return 1;
  const RelativeDensity density(angles);
  double same = 0, all = 0;
  for (std::size_t k = 0; k < sines.size(); ++k)
    if (hits[k] > 0) same += hits[k] * same_tilted_leaf(density, sines[k]), all += hits[k];
  if (!(all > 0)) return 1;
  double low = kMinSideM, high = kMaxSideM;
  for (int step = 0; step < 30; ++step) {
    const double side = std::sqrt(low * high);
    (same_leaf(kTiltedDistanceM, side, kUsualWindows).centre < same / all ? low : high) = side;
  }
  return std::sqrt(low * high) / kTiltedSideM;
}

LeafShadow leaf_shadow(double area_m2, double voxel_m) {
  if (!(area_m2 > 0) || !(voxel_m > 0)) return {};
  const double side = std::sqrt(area_m2), dt = voxel_m / 24;
  const int steps = ceil_int((1.75 * voxel_m + 2 * side) / dt);
  Uniform uniform(20181212);
  // Share of places of a point in the voxel for which it is there with these two shifts of itself.
  const auto overlap = [voxel_m](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    double p = 1;
    for (int k = 0; k < 3; ++k)
      p *= std::max(0.0, 1 - (std::max({0.0, a[k], b[k]}) - std::min({0.0, a[k], b[k]})) / voxel_m);
    return p;
  };
  // Lengths of shadow in the voxel, by whether the point of the leaf that casts it lies there too.
  double all = 0, inside = 0, hits = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d normal = direction(uniform), ray = direction(uniform);
    const Eigen::Vector3d axis_u = normal.unitOrthogonal(), axis_v = normal.cross(axis_u);
    // From the hit, inside the voxel, to another random point of the leaf.
    const Eigen::Vector3d offset = side * ((uniform() - uniform()) * axis_u + (uniform() - uniform()) * axis_v);
    const double cosine = std::abs(normal.dot(ray));  // hits are as frequent, and shadows as wide
    hits += cosine;
    const auto [first, last] = steps_within(offset, ray, voxel_m, dt, steps);
    for (int step = first; step < last; ++step) {
      const Eigen::Vector3d at = offset + (step + 0.5) * dt * ray;
      all += dt * cosine * cosine * overlap(at, at);
      inside += dt * cosine * cosine * overlap(offset, at);
    }
  }
  const double share = area_m2 / (hits * voxel_m * voxel_m * voxel_m);
  return {share * (all - inside), share * inside};
}

}  // namespace rayfield::density
