#include "sim/drive/path.h"

#include <algorithm>
#include <cmath>

#include "sim/terrain/smooth_noise.h"

namespace rayfield::sim {
namespace {

constexpr double kControlStep = 0.5;     // m between control points of the curve
constexpr double kPolygonStep = 0.1;     // m between points of the raw way
constexpr double kHeadland = 2.0;        // m driven straight beyond the end of a lane
constexpr double kRunUp = 2.0;           // m more before the first lane and after the last
constexpr double kTurnDepth = 4.5;       // m, greatest reach of a turn beyond the headland line
constexpr double kWanderWavelength = 9;  // m

using Points = std::vector<Eigen::Vector2d>;

void add_straight(Points& points, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int steps = std::max(1, static_cast<int>(std::lround((to - from).norm() / kPolygonStep)));
  for (int i = 0; i < steps; ++i) points.push_back(from + (to - from) * (static_cast<double>(i) / steps));
}

// A cubic Bézier from `from` (leaving along `out`) to `to` (arriving against `out_to`); for parallel lanes close
// together nearly a half circle.
void add_turn(Points& points, const Eigen::Vector2d& from, const Eigen::Vector2d& out, const Eigen::Vector2d& to,
              const Eigen::Vector2d& out_to) {
  const double distance = (to - from).norm();
  const double handle = std::min(2.0 / 3 * distance, 4.0 / 3 * kTurnDepth);
  const Eigen::Vector2d a = from + handle * out, b = to + handle * out_to;
  const int steps = std::max(8, static_cast<int>(1.6 * distance / kPolygonStep));
  for (int i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps, s = 1 - t;
    points.push_back(s * s * s * from + 3 * s * s * t * a + 3 * s * t * t * b + t * t * t * to);
  }
}

// Points `kControlStep` apart on a polygon, by arc length; also the arc length at given points.
Points resample(const Points& points, const std::vector<std::size_t>& marks, std::vector<double>& mark_lengths) {
  Points even{points.front()};
  double length = 0, next = kControlStep;
  std::size_t mark = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    while (mark < marks.size() && marks[mark] == i) mark_lengths.push_back(length), ++mark;
    const double piece = (points[i + 1] - points[i]).norm();
    while (next <= length + piece && piece > 0) {
      even.push_back(points[i] + (points[i + 1] - points[i]) * ((next - length) / piece));
      next += kControlStep;
    }
    length += piece;
  }
  while (mark++ < marks.size()) mark_lengths.push_back(length);
  return even;
}

}  // namespace

std::vector<int> lane_order(const Site& site, const SiteDate& date) {
  if (!date.lanes.empty()) return date.lanes;
  const int count = site.rows.count + 1;
  std::vector<int> lanes;
  switch (date.order) {
    case LaneOrder::skip:
      for (int lane = 0; lane < count; lane += 2) lanes.push_back(lane);
      for (int lane = (count - 2) | 1; lane > 0; lane -= 2)
        if (lane < count) lanes.push_back(lane);
      break;
    case LaneOrder::sequential:
      for (int lane = 0; lane < count; ++lane) lanes.push_back(lane);
      break;
    case LaneOrder::reverse:
      for (int lane = count - 1; lane >= 0; --lane) lanes.push_back(lane);
      break;
  }
  return lanes;
}

// Strings the lanes (with wander) and the headland turns into one polygon, resamples it evenly and lays a spline over
// it.
Path plan_path(const BlockGeometry& block, const std::vector<int>& lanes, double wander_m, std::uint64_t seed) {
  const double half = 0.5 * block.row_length() + kHeadland;
  Points points;
  std::vector<std::size_t> marks;  // alternately begin and end of turns
  Eigen::Vector2d exit = Eigen::Vector2d::Zero(), exit_direction = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    const double lateral = block.lane_lateral(lanes[i]);
    const auto at = [&](double along) -> Eigen::Vector2d {
      const double wander =
          wander_m * smooth_noise(seed, Stream::lane_wander, i, 2 * (along + half) / kWanderWavelength);
      const Eigen::Vector2d direction = block.direction(lateral, sign * along);
      return block.point(lateral, sign * along) + wander * Eigen::Vector2d(direction.y(), -direction.x());
    };
    const Eigen::Vector2d entry = at(-half), inwards = sign * block.direction(lateral, -sign * half);
    if (i == 0) {
      add_straight(points, entry - kRunUp * inwards, entry);
    } else {
      marks.push_back(points.size());
      add_turn(points, exit, exit_direction, entry, -inwards);
      marks.push_back(points.size());
    }
    const int steps = static_cast<int>(2 * half / kPolygonStep);
    for (int k = 0; k < steps; ++k) points.push_back(at(-half + 2 * half * k / steps));
    exit = at(half), exit_direction = sign * block.direction(lateral, sign * half);
  }
  add_straight(points, exit, exit + kRunUp * exit_direction);

  Path path;
  std::vector<double> lengths;
  Points control = resample(points, marks, lengths);
  for (std::size_t i = 0; i + 1 < lengths.size(); i += 2) path.turns.push_back({lengths[i], lengths[i + 1]});
  // At its start the curve passes its third control point (symmetric weights), at its end the third last: two points
  // more at either side, on the straight ends, make it run from the first to the last.
  const Eigen::Vector2d lead = control[0] - control[1], tail = control.back() - control[control.size() - 2];
  Points padded{control[0] + 2 * lead, control[0] + lead};
  padded.insert(padded.end(), control.begin(), control.end());
  for (int i = 1; i <= 2; ++i) padded.push_back(control.back() + i * tail);
  path.curve = UniformSpline<2>(0, kControlStep, std::move(padded));
  return path;
}

}  // namespace rayfield::sim
