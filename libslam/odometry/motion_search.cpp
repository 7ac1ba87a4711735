#include "libslam/odometry/motion_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr float kSweepMin = 1.5f, kSweepMax = 2.6f;  // s between two looks at one place
constexpr float kReach = 15.0f;                      // m; further points are too sparse to meet again
constexpr std::size_t kMaxPoints = 8000;

struct TimedPoint {
  Eigen::Vector3f position;  // without the motion that is searched
  float time_s;
};

std::uint64_t cell_key(const Eigen::Vector3f& p, float cell_m) {
  const auto part = [&](float v) {
    return static_cast<std::uint64_t>(static_cast<int>(std::floor(v / cell_m)) + (1 << 20)) & 0x1fffff;
  };
  return (part(p.x()) << 42) | (part(p.y()) << 21) | part(p.z());
}

// Points more than 0.4 m above the lowest one in their 2 m column: level ground agrees with any motion.
std::vector<TimedPoint> above_ground(const std::vector<TimedPoint>& points) {
  const auto column = [](const TimedPoint& p) { return cell_key({p.position.x(), p.position.y(), 0}, 2.0f); };
  std::map<std::uint64_t, float> lowest;
  for (const TimedPoint& p : points) {
    const auto [it, fresh] = lowest.try_emplace(column(p), p.position.z());
    if (!fresh) it->second = std::min(it->second, p.position.z());
  }
  std::vector<TimedPoint> out;
  for (const TimedPoint& p : points)
    if (p.position.z() > lowest[column(p)] + 0.4f) out.push_back(p);
  const std::size_t stride = out.size() / kMaxPoints + 1;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < out.size(); k += stride) out[kept++] = out[k];
  out.resize(kept);
  return out;
}

// Points that share a cell with one of the sweep before.
std::size_t agreement(std::span<const TimedPoint> points, const QuadraticMotion& motion, float cell_m) {
  std::vector<std::pair<std::uint64_t, float>> touched;
  touched.reserve(points.size());
  for (const TimedPoint& p : points) {
    const Eigen::Vector3f moved = p.position + quadratic_at(motion, static_cast<double>(p.time_s)).cast<float>();
    touched.emplace_back(cell_key(moved, cell_m), p.time_s);
  }
  std::sort(touched.begin(), touched.end());
  std::size_t met = 0, first = 0;
  for (std::size_t k = 0; k < touched.size(); ++k) {
    while (touched[first].first != touched[k].first || touched[first].second < touched[k].second - kSweepMax) ++first;
    met += touched[first].second <= touched[k].second - kSweepMin;
  }
  return met;
}

// The candidate with the highest agreement; the lowest index among equals.
std::size_t best_of(std::size_t count, const std::function<QuadraticMotion(std::size_t)>& candidate,
                    std::span<const TimedPoint> points, float cell_m, int threads) {
  std::vector<std::size_t> score(count, 0);
  parallel_each(count, threads, [&](std::size_t k, int) { score[k] = agreement(points, candidate(k), cell_m); });
  return static_cast<std::size_t>(std::max_element(score.begin(), score.end()) - score.begin());
}

QuadraticMotion with_velocity(QuadraticMotion motion, const Eigen::Vector3d& velocity) {
  motion.row(1) += velocity.transpose();
  return motion;
}

}  // namespace

QuadraticMotion fit_quadratic(std::span<const std::pair<double, Eigen::Vector3d>> samples) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), right = Eigen::Matrix3d::Zero();
  for (const auto& [t, p] : samples) {
    const Eigen::Vector3d basis(1, t, t * t);
    normal += basis * basis.transpose();
    right += basis * p.transpose();
  }
  return normal.ldlt().solve(right);
}

Eigen::Vector3d quadratic_at(const QuadraticMotion& motion, double time_s) {
  return motion.transpose() * Eigen::Vector3d(1, time_s, time_s * time_s);
}

// Places the points without the unknown motion, then searches in steps: headings of the GPS path if there is one, then
// velocities on two grids of decreasing spacing.
QuadraticMotion search_motion(std::span<const BodyPoint> points, const PoseTrack& track,
                              const std::optional<QuadraticMotion>& gps, const Eigen::Vector3d& gps_arm_m,
                              double max_speed, int threads) {
  std::vector<TimedPoint> all;
  for (const BodyPoint& p : points)
    if (p.time_s <= track.end_s() && p.position.squaredNorm() < kReach * kReach)
      all.push_back({(track.pose(p.time_s) * p.position.cast<double>()).cast<float>(), static_cast<float>(p.time_s)});
  const std::vector<TimedPoint> upright = above_ground(all);

  // The vehicle climbs with the slope it stands on: velocities lie in the plane of its floor.
  Eigen::Vector3d floor_normal = Eigen::Vector3d::Zero();
  std::vector<std::pair<double, Eigen::Vector3d>> arms;
  for (int k = 0; k < track.size(); ++k) {
    floor_normal += track.rotation[k] * Eigen::Vector3d::UnitZ();
    arms.emplace_back(k * track.step_s, track.rotation[k] * gps_arm_m);
  }
  const Eigen::Quaterniond floor = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), floor_normal);

  QuadraticMotion best = QuadraticMotion::Zero();
  double step = 0.1, reach = max_speed;
  if (gps) {
    // fix(t) = Rz(ψ)·(p(t) + r(t)·arm)  →  p(t) = Rz(−ψ)·fix(t) − r(t)·arm, as quadratics.
    const QuadraticMotion arm = fit_quadratic(arms);
    constexpr std::size_t kHeadings = 720;
    const auto heading = [&](std::size_t k) -> QuadraticMotion {
      const double yaw = 2 * std::numbers::pi * static_cast<double>(k) / kHeadings;
      QuadraticMotion motion =
          *gps * Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix().transpose() - arm;
      motion.row(0).setZero();
      return motion;
    };
    best = heading(best_of(kHeadings, heading, upright, 0.3f, threads));
    reach = 0.2;
  }
  for (const float cell_m : {0.25f, 0.15f}) {
    const int n = static_cast<int>(std::ceil(reach / step));
    const std::size_t side = static_cast<std::size_t>(2 * n + 1);
    const auto candidate = [&](std::size_t k) {
      const std::size_t column = k % side, row = k / side;
      const double x = (static_cast<double>(column) - n) * step, y = (static_cast<double>(row) - n) * step;
      return with_velocity(best, floor * Eigen::Vector3d(x, y, 0));
    };
    best = candidate(best_of(side * side, candidate, upright, cell_m, threads));
    reach = 2 * step, step /= 3;
  }
  return best;
}

}  // namespace rayfield::slam
