#include "libslam/surfels/pole_observations.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace rayfield::slam {
namespace {

// Indices by squares of the plan, in slices of height.
class PlanIndex {
 public:
  PlanIndex(double edge_m, double slice_m) : edge_m_(edge_m), slice_m_(slice_m) {}

  void add(const Eigen::Vector3d& p, std::size_t index) { squares_[square_of(p)].push_back(index); }

  // Calls use(index) for what lies in the nine squares around p, in its slice.
  template <class Use>
  void for_each_near(const Eigen::Vector3d& p, const Use& use) const {
    const auto [z, y, x] = square_of(p);
    for (std::int64_t dy = -1; dy <= 1; ++dy)
      for (std::int64_t dx = -1; dx <= 1; ++dx)
        if (const auto found = squares_.find({z, y + dy, x + dx}); found != squares_.end())
          for (const std::size_t index : found->second) use(index);
  }

 private:
  using Square = std::tuple<std::int64_t, std::int64_t, std::int64_t>;  // z, y, x
  Square square_of(const Eigen::Vector3d& p) const {
    const auto floor = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
    return {floor(p.z() / slice_m_), floor(p.y() / edge_m_), floor(p.x() / edge_m_)};
  }

  double edge_m_, slice_m_;
  std::map<Square, std::vector<std::size_t>> squares_;
};

// Sums over the detections of an observation, in the world.
struct DetectionSums {
  double time_sum = 0, last_s = 0, spin_sum = 0;
  Eigen::Vector3d center_sum = Eigen::Vector3d::Zero(), view_sum = center_sum, axis_sum = center_sum;
  int count = 0;
  Eigen::Vector3d axis() const { return axis_sum / count; }
};

// When the vehicle is abreast of a place that it sees at about `time_s`: the place is then neither ahead nor behind.
double time_abreast(const PoseTrack& track, const Eigen::Vector3d& place, double time_s) {
  constexpr double kSlow_m_s = 0.2, kLongest_s = 3;
  double t = time_s;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d velocity = track.velocity(t).head<2>();
    if (velocity.norm() < kSlow_m_s) break;
    const Eigen::Vector2d ahead = (place - track.pose(t).translation).head<2>();
    t = std::clamp(t + ahead.dot(velocity) / velocity.squaredNorm(), std::max(0.0, time_s - kLongest_s),
                   std::min(track.end_s(), time_s + kLongest_s));
  }
  return t;
}

PoleObservation observation_of(const DetectionSums& g, const PoseTrack& track) {
  PoleObservation v;
  v.time_s = time_abreast(track, g.axis(), g.time_sum / g.count);
  const Rigid3 inverse = track.pose(v.time_s).inverse();
  v.center = inverse * Eigen::Vector3d(g.center_sum / g.count);
  v.view = inverse.rotation * (g.view_sum / g.count);
  v.spin_rate_rad_s = static_cast<float>(g.spin_sum / g.count);
  v.detections = g.count;
  return v;
}

// Numbers places so that those within `radius_m`, in plan, of the first that has a number share it.
std::vector<std::size_t> number_poles(std::span<const Eigen::Vector3d> axes, double radius_m) {
  std::vector<Eigen::Vector3d> firsts;
  PlanIndex index(radius_m, 1);
  std::vector<std::size_t> out;
  for (const Eigen::Vector3d& axis : axes) {
    const Eigen::Vector3d plan(axis.x(), axis.y(), 0);
    std::size_t nearest = firsts.size();
    double least = radius_m;
    index.for_each_near(plan, [&](std::size_t k) {
      const double distance = (firsts[k] - plan).norm();
      if (distance < least) least = distance, nearest = k;
    });
    if (nearest == firsts.size()) firsts.push_back(plan), index.add(plan, nearest);
    out.push_back(nearest);
  }
  return out;
}

// A detection is often a single scan line, anywhere on a pole of the radius r = 4/π·depth: uniform across the view,
// with the standard deviation r/√3, and so in depth 0.22·r. Both directions together: √(½·(1/3 + 0.22²))·4/π of the
// depth.
double offset_variance(const PoleObservation& a, const PoleObservation& b, double depth_m, const PoleOptions& options) {
  const double line = 0.56 * depth_m;
  return 2 * options.sigma_m * options.sigma_m + line * line * (1.0 / a.detections + 1.0 / b.detections);
}

// The offset of the surfaces of a pair and of its views, in plan: that of the axes is surface + depth·view.
struct PairOffset {
  Eigen::Vector2d surface, view;
};
PairOffset offset_of(const PoleObservation& a, const PoleObservation& b, const PoseTrack& track) {
  const Rigid3 pose_a = track.pose(a.time_s), pose_b = track.pose(b.time_s);
  return {(pose_b * b.center - pose_a * a.center).head<2>(),
          (pose_b.rotation * b.view - pose_a.rotation * a.view).head<2>()};
}

// Gives every pair the depth k of its pole and what follows from it. The depth minimises, with the offsets d of
// surfaces and v of views of its pairs,
//   Σ 2/N·ρ₁(|d + k·v|/s) + ρ₂((k − depth)/thickness_sigma),   ρ₁ = ½·ln(1 + x²), ρ₂ = ½·x²/(1 + x²/4):
// most poles are alike and a few, such as those at the ends of rows, are much thicker without moving the others. ρ₂ is
// a parabola of the variance (thickness_sigma·(1 + x²/4))² there. With the depth eliminated the pairs of a pole are
// less certain along v; all n of them share its error, so that each counts it n times.
void find_depths(std::span<const PoleObservation> observations, std::span<const std::size_t> pole,
                 const PoseTrack& track, double depth_m, const PoleOptions& options, std::span<PolePair> pairs) {
  constexpr int kIterations = 15, kShrinking = 5;
  constexpr double kFirstSlack = 0.1;  // m: at first thick poles look like wrong matches
  struct Sum {
    double information = 0, pull = 0;
  };
  std::size_t poles = 0;
  for (const std::size_t p : pole) poles = std::max(poles, p + 1);
  std::vector<double> excess(poles, 0.0);  // k − depth
  std::vector<PairOffset> offsets;
  for (const PolePair& p : pairs) offsets.push_back(offset_of(observations[p.first], observations[p.second], track));
  std::vector<Sum> sums;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double slack = kFirstSlack * std::min(1.0, (kIterations - 1.0 - iteration) / kShrinking);
    sums.assign(poles, {});
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const PolePair& p = pairs[k];
      const auto& [surface, view] = offsets[k];
      Sum& sum = sums[pole[p.first]];
      const double depth = depth_m + excess[pole[p.first]];
      const double variance = offset_variance(observations[p.first], observations[p.second], depth, options);
      const double square = (surface + depth * view).squaredNorm();
      const double weight = 2 / (p.observations * variance * (1 + square / (variance + slack * slack)));
      sum.information += weight * view.squaredNorm();
      sum.pull -= weight * view.dot(surface + depth_m * view);
    }
    for (std::size_t n = 0; n < poles; ++n) {
      const double x = excess[n] / options.thickness_sigma_m, far = 1 + 0.25 * x * x;
      const double prior = 1 / (options.thickness_sigma_m * options.thickness_sigma_m * far * far);
      excess[n] = sums[n].pull / (sums[n].information + prior);
    }
  }
  std::vector<int> count(poles, 0);
  for (const PolePair& p : pairs) ++count[pole[p.first]];
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    PolePair& p = pairs[k];
    const std::size_t n = pole[p.first];
    p.depth_m = depth_m + excess[n];
    p.variance_m2 = offset_variance(observations[p.first], observations[p.second], p.depth_m, options);
    const double length = offsets[k].view.norm(), x = excess[n] / options.thickness_sigma_m;
    if (length > 1e-3) p.sides << offsets[k].view / length, 0;
    const double sigma = options.thickness_sigma_m * (1 + 0.25 * x * x) * length;
    p.thickness_variance_m2 = count[n] * sigma * sigma;
  }
}

}  // namespace

std::vector<PoleObservation> gather_observations(std::span<const Surfel> detections, const PoseTrack& track,
                                                 double depth_m, const PoleOptions& options) {
  std::vector<DetectionSums> gathered;
  PlanIndex index(2 * options.gather_m, options.slice_m);  // of observations by where they began
  for (const Surfel& s : detections) {
    const Rigid3 pose = track.pose(s.time_s);
    const Eigen::Vector3d center = pose * s.center.cast<double>(), view = -(pose.rotation * s.normal.cast<double>());
    const Eigen::Vector3d axis = center + depth_m * view;
    std::size_t nearest = gathered.size();
    double least = options.gather_m;
    index.for_each_near(axis, [&](std::size_t k) {
      if (s.time_s - gathered[k].last_s > options.max_pause_s) return;
      const double distance = (gathered[k].axis() - axis).head<2>().norm();
      if (distance < least) least = distance, nearest = k;
    });
    if (nearest == gathered.size()) gathered.emplace_back(), index.add(axis, nearest);
    DetectionSums& g = gathered[nearest];
    g.time_sum += s.time_s, g.last_s = s.time_s, g.spin_sum += static_cast<double>(s.spin_rate_rad_s);
    g.center_sum += center, g.view_sum += view, g.axis_sum += axis;
    ++g.count;
  }
  std::vector<PoleObservation> out;
  for (const DetectionSums& g : gathered) out.push_back(observation_of(g, track));
  return out;
}

std::vector<PolePair> pair_observations(std::span<const PoleObservation> observations, const PoseTrack& track,
                                        double depth_m, const PoleQuery& query, const PoleOptions& options) {
  std::vector<Eigen::Vector3d> axes;
  PlanIndex index(query.reach_m, options.slice_m);
  for (const PoleObservation& v : observations) {
    axes.push_back(track.pose(v.time_s) * Eigen::Vector3d(v.center + depth_m * v.view));
    index.add(axes.back(), axes.size() - 1);
  }
  std::vector<PolePair> out;
  std::vector<int> partners(observations.size(), 0);
  for (std::size_t a = 0; a < observations.size(); ++a)
    index.for_each_near(axes[a], [&](std::size_t b) {
      const double gap = std::abs(observations[b].time_s - observations[a].time_s);
      if (b <= a || gap < query.min_gap_s || gap >= query.max_gap_s) return;
      if ((axes[b] - axes[a]).head<2>().norm() > query.reach_m) return;
      out.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
      ++partners[a], ++partners[b];
    });
  for (PolePair& p : out) p.observations = 1 + 0.5 * (partners[p.first] + partners[p.second]);
  find_depths(observations, number_poles(axes, options.gather_m), track, depth_m, options, out);
  return out;
}

}  // namespace rayfield::slam
