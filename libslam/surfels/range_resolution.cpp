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

struct GroundSurfel {
  double time_s = 0;
  Eigen::Vector3d center, normal;  // in the frame of the track
  double spot_depth_m = 0;
  double cos_incidence = 1;
  std::uint8_t level = 0;
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

  const std::vector<SpotLift>& pairs() const { return pairs_; }

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
  std::vector<SpotLift> pairs_;
};

}  // namespace

Result<std::optional<RangeResolution>> measure_range_resolution(const SurfelFile& surfels, const PoseTrack& track,
                                                                const BeamSource& source,
                                                                std::span<const double> voxel_size_m) {
  PairFinder finder(track, source, voxel_size_m);
  RAYFIELD_CHECK(surfels.for_each([&](std::span<const Surfel> some) -> Result<void> {
    for (const Surfel& s : some) finder.add(s);
    return {};
  }));
  const std::span<const SpotLift> pairs = finder.pairs();
  const auto deep =
      std::count_if(pairs.begin(), pairs.end(), [](const SpotLift& p) { return p.spot_depth_m > kDeepSpot_m; });
  if (static_cast<std::size_t>(deep) < kMinDeepPairs) return std::optional<RangeResolution>();
  return std::optional(fit_range_resolution(pairs));
}

}  // namespace rayfield::slam
