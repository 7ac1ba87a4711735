#include "libslam/surfels/range_resolution.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

namespace rayfield::slam {
namespace {

constexpr double kSteepSpot_m = 0.03;  // spots less deep than this give the ground's true height
constexpr double kDeepSpot_m = 0.1;    // spots deep enough to show it
constexpr std::size_t kMinDeepPairs = 200;
constexpr double kUpright = 0.9;  // n_z of ground
constexpr float kMaxVariance_m2 = 0.02f * 0.02f;
constexpr double kMinGap_s = 0.7, kMaxGap_s = 6;  // between the two looks
constexpr double kReach_voxels = 0.3;             // between the two surfels in plan
constexpr double kMinEdge_m = 0.5;                // of the voxels: smaller ones show ground too roughly
constexpr double kLiftSigma_m = 0.003;            // of one pair
constexpr double kMaxDeviations = 3;              // beyond, pairs cost no more: relief, grass
constexpr int kSections = 8;
constexpr double kStep = 1.03;  // from one resolution that is tried to the next
constexpr int kSteps = 156;     // down to 1 cm

struct GroundSurfel {
  double time_s = 0;
  Eigen::Vector3d center, normal;  // in the frame of the track
  double spot_depth_m = 0;
  double cos_incidence = 1;
  std::uint8_t level = 0;
};

// Ground seen aslant, against the same ground seen steeply.
struct LiftPair {
  double spot_depth_m = 0, cos_incidence = 1;
  double lift_m = 0;  // along the ground's normal
};

class PairFinder {
 public:
  PairFinder(const PoseTrack& track, const BeamSource& source, std::span<const double> voxel_size_m)
      : track_(track), source_(source), voxel_size_m_(voxel_size_m) {}

  void add(const Surfel& surfel) {
    if (surfel.variance_m2 > kMaxVariance_m2 || voxel_size_m_[surfel.level] < kMinEdge_m) return;
    const Rigid3 pose = track_.pose(surfel.time_s);
    const Eigen::Vector3d center = surfel.center.cast<double>(), normal = surfel.normal.cast<double>();
    GroundSurfel g;
    g.normal = pose.rotation * normal;
    if (g.normal.z() < kUpright) return;
    g.time_s = surfel.time_s, g.center = pose * center, g.level = surfel.level;
    g.spot_depth_m = source_.spot_depth_m(center, normal);
    const Eigen::Vector3d ray = center - source_.origin;
    g.cos_incidence = std::abs(ray.dot(normal)) / ray.norm();
    const bool is_steep = g.spot_depth_m < kSteepSpot_m;
    std::deque<GroundSurfel>& own = is_steep ? steep_ : aslant_;
    std::deque<GroundSurfel>& others = is_steep ? aslant_ : steep_;
    while (!others.empty() && others.front().time_s < g.time_s - kMaxGap_s) others.pop_front();
    while (!own.empty() && own.front().time_s < g.time_s - kMaxGap_s) own.pop_front();
    match(g, others, is_steep);
    own.push_back(g);
  }

  const std::vector<LiftPair>& pairs() const { return pairs_; }

 private:
  // Pairs a surfel with the nearest that was seen before from the other angle.
  void match(const GroundSurfel& g, const std::deque<GroundSurfel>& others, bool is_steep) {
    const double reach = kReach_voxels * voxel_size_m_[g.level];
    const GroundSurfel* nearest = nullptr;
    double least = reach * reach;
    for (const GroundSurfel& o : others) {
      const double square = (o.center - g.center).head<2>().squaredNorm();
      if (square >= least || o.level != g.level || g.time_s - o.time_s < kMinGap_s) continue;
      least = square, nearest = &o;
    }
    if (nearest == nullptr) return;
    const GroundSurfel &steep = is_steep ? g : *nearest, &aslant = is_steep ? *nearest : g;
    pairs_.push_back({aslant.spot_depth_m, aslant.cos_incidence, steep.normal.dot(aslant.center - steep.center)});
  }

  const PoseTrack& track_;
  const BeamSource& source_;
  std::span<const double> voxel_size_m_;
  std::deque<GroundSurfel> steep_, aslant_;
  std::vector<LiftPair> pairs_;
};

// Mean deviation of the pairs' lifts from those that a resolution predicts, in standard deviations; far-off pairs count
// as kMaxDeviations.
double misfit(std::span<const LiftPair> pairs, double resolution_m) {
  double sum = 0;
  for (const LiftPair& p : pairs) {
    const double predicted = p.cos_incidence * spot_shift_m(p.spot_depth_m, resolution_m);
    sum += std::min(kMaxDeviations, std::abs(p.lift_m - predicted) / kLiftSigma_m);
  }
  return sum / static_cast<double>(pairs.size());
}

// The resolution of least misfit, to 3 %.
double best_resolution(std::span<const LiftPair> pairs) {
  double best = kMaxRangeResolution_m, least = misfit(pairs, best);
  for (int k = 1; k < kSteps; ++k) {
    const double b = kMaxRangeResolution_m * std::pow(kStep, -k);
    const double m = misfit(pairs, b);
    if (m < least) least = m, best = b;
  }
  return best;
}

}  // namespace

// Depths in units of half the spot's, from −1 at the near edge: the disc has the energy 2·√(1 − x²) dx there. Up to the
// depth c its energy is acos(−c) + c·√(1 − c²), and the mean depth −(2/3)·(1 − c²)^(3/2) over that.
double spot_shift_m(double spot_depth_m, double resolution_m) {
  if (resolution_m >= spot_depth_m) return 0;
  const double c = 2 * resolution_m / spot_depth_m - 1, s = std::sqrt(std::max(0.0, 1 - c * c));
  const double energy = std::acos(-c) + c * s;
  if (energy < 1e-9) return 0.5 * spot_depth_m;
  return 0.5 * spot_depth_m * (2.0 / 3) * s * s * s / energy;
}

Result<std::optional<RangeResolution>> measure_range_resolution(const SurfelFile& surfels, const PoseTrack& track,
                                                                const BeamSource& source,
                                                                std::span<const double> voxel_size_m) {
  PairFinder finder(track, source, voxel_size_m);
  RAYFIELD_CHECK(surfels.for_each([&](std::span<const Surfel> some) -> Result<void> {
    for (const Surfel& s : some) finder.add(s);
    return {};
  }));
  const std::span<const LiftPair> pairs = finder.pairs();
  const auto deep =
      std::count_if(pairs.begin(), pairs.end(), [](const LiftPair& p) { return p.spot_depth_m > kDeepSpot_m; });
  if (static_cast<std::size_t>(deep) < kMinDeepPairs) return std::optional<RangeResolution>();
  RangeResolution out;
  out.pairs = pairs.size();
  out.value_m = best_resolution(pairs);
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < kSections; ++k) {  // in the order of time
    const std::size_t begin = k * pairs.size() / kSections, end = (k + 1) * pairs.size() / kSections;
    const double b = best_resolution(pairs.subspan(begin, end - begin));
    sum += b, squares += b * b;
  }
  const double mean = sum / kSections;
  out.sigma_m = std::sqrt(std::max(0.0, squares / kSections - mean * mean) / (kSections - 1));
  return std::optional(out);
}

}  // namespace rayfield::slam
