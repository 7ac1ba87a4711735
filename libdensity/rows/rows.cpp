#include "libdensity/rows/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libdensity/layout/polyline.h"
#include "libdensity/layout/row_order.h"
#include "libdensity/rows/ridge.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

double angle_between_lines(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::acos(std::clamp(std::abs(a.normalized().dot(b.normalized())), 0.0, 1.0));
}

bool cross(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  int before = 0;
  for (const auto& p : a) {
    const LineProjection on_line = project_onto_line(b, p);
    const int side = !on_line.inside ? 0 : on_line.across_m > 0 ? 1 : -1;
    if (side * before < 0) return true;
    before = side;
  }
  return false;
}

// Strongest seeds first; one that lies on a ridge already traced adds nothing.
std::vector<Ridge> trace_all(const std::vector<Pass>& passes, const CanopyMap& canopy, const RowOptions& options) {
  std::vector<RidgeSeed> seeds;
  for (const Pass& pass : passes) {
    const auto more = find_seeds(pass, canopy, options);
    seeds.insert(seeds.end(), more.begin(), more.end());
  }
  std::sort(seeds.begin(), seeds.end(), [](const RidgeSeed& a, const RidgeSeed& b) {
    return std::make_tuple(-a.strength, a.position.x(), a.position.y()) <
           std::make_tuple(-b.strength, b.position.x(), b.position.y());
  });
  std::vector<Ridge> ridges;
  for (const RidgeSeed& seed : seeds) {
    const bool known = std::any_of(ridges.begin(), ridges.end(), [&](const Ridge& ridge) {
      const LineProjection on_line = project_onto_line(ridge.line, seed.position);
      return on_line.inside && std::abs(on_line.across_m) < 0.6 &&
             angle_between_lines(seed.direction, point_at(ridge.line, on_line.chainage_m).direction) < M_PI / 6;
    });
    if (known) continue;
    if (auto ridge = trace_ridge(seed, canopy, options)) ridges.push_back(std::move(*ridge));
  }
  return ridges;
}

// Why a ridge, by itself, is not a row; empty if it may be one.
std::string refuse(const Ridge& ridge, double driven, double usual_strength, const RowOptions& options) {
  if (ridge.tall_share > options.max_tall_share)
    return fmt::format("taller than vines along {:.0f} % of its length", 100 * ridge.tall_share);
  if (ridge.cover < options.min_cover)
    return fmt::format("canopy along only {:.0f} % of its length", 100 * ridge.cover);
  if (ridge.lane_share > options.max_lane_share)
    return fmt::format("as much canopy beside it as in it ({:.0f} %)", 100 * ridge.lane_share);
  if (driven < 0.5) return fmt::format("driven along for only {:.0f} % of its length", 100 * driven);
  if (ridge.strength < options.min_strength_share * usual_strength)
    return fmt::format("canopy of {:.0f} % of the usual row", 100 * ridge.strength / usual_strength);
  return {};
}

}  // namespace

std::pair<double, double> driven_shares(std::span<const Eigen::Vector2d> line, std::span<const Pass> passes,
                                        const RowOptions& options) {
  const double length = polyline_length(line);
  const std::size_t bins = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length)));
  std::vector<bool> left(bins, false), right(bins, false);
  for (const Pass& pass : passes)
    for (std::size_t i = 0; i < pass.line.size(); ++i) {
      const LineProjection on_line = project_onto_line(line, pass.line[i]);
      if (!on_line.inside || std::abs(on_line.across_m) > options.max_offset_m + 0.5) continue;
      const Eigen::Vector2d u = pass.line[std::min(i + 1, pass.line.size() - 1)] - pass.line[i > 0 ? i - 1 : 0];
      if (angle_between_lines(u, point_at(line, on_line.chainage_m).direction) > M_PI / 6) continue;
      const std::size_t bin =
          std::min(bins - 1, static_cast<std::size_t>(on_line.chainage_m / length * static_cast<double>(bins)));
      (on_line.across_m > 0 ? left : right)[bin] = true;
    }
  const auto share = [bins](const std::vector<bool>& seen) {
    return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(bins);
  };
  return {share(left), share(right)};
}

double share_beside(std::span<const Eigen::Vector2d> line, std::span<const Eigen::Vector2d> other, double distance_m) {
  std::size_t near = 0;
  for (const auto& p : line) {
    const LineProjection on_line = project_onto_line(other, p);
    if (on_line.inside && std::abs(on_line.across_m) < distance_m) ++near;
  }
  return static_cast<double>(near) / static_cast<double>(line.size());
}

Result<RowFindings> find_rows(std::span<const PathPoint> path, const CanopyMap& canopy, const RowOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RowFindings out;
  const std::vector<Pass> passes = find_passes(path, options.passes);

  std::vector<Ridge> ridges = trace_all(passes, canopy, options);
  std::vector<std::pair<double, double>> driven;
  std::vector<double> strengths;
  for (const Ridge& ridge : ridges) {
    driven.push_back(driven_shares(ridge.line, passes, options));
    if (refuse(ridge, std::max(driven.back().first, driven.back().second), 0, options).empty())
      strengths.push_back(ridge.strength);
  }
  const double usual = median_of(std::move(strengths), 0);

  // The most canopy first, so that a doubtful line gives way to a sure one.
  std::vector<std::size_t> order(ridges.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto mass = [&](std::size_t i) { return ridges[i].strength * polyline_length(ridges[i].line); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return mass(a) > mass(b); });
  for (std::size_t i : order) {
    const Ridge& ridge = ridges[i];
    std::string reason = refuse(ridge, std::max(driven[i].first, driven[i].second), usual, options);
    for (const Row& row : out.layout.rows) {
      if (!reason.empty()) break;
      if (share_beside(ridge.line, row.centreline, 0.7) > 0.3) {
        reason = "the same as another row";
      } else if (cross(ridge.line, row.centreline)) {
        reason = "crosses another row";
      }
    }
    if (!reason.empty()) {
      out.rejected.push_back({ridge.line, reason});
      continue;
    }
    Row row;
    row.centreline = ridge.line;
    row.seen_from_left = driven[i].first >= 0.5, row.seen_from_right = driven[i].second >= 0.5;
    out.layout.rows.push_back(std::move(row));
  }
  number_rows(out.layout);
  return out;
}

}  // namespace rayfield::density
