#include "libdensity/layout/row_order.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "libdensity/layout/polyline.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr double kNearlyEast = 15 * M_PI / 180;  // rows closer to east-west than this point east
constexpr double kSameDirection = 15 * M_PI / 180;
constexpr double kWidestLane = 8;  // m between neighbouring rows of one block

Eigen::Vector2d chord(const Row& row) { return (row.centreline.back() - row.centreline.front()).normalized(); }
Eigen::Vector2d middle(const Row& row) { return point_at(row.centreline, 0.5 * row.length_m()).position; }

void reverse(Row& row) {
  std::reverse(row.centreline.begin(), row.centreline.end());
  std::swap(row.seen_from_left, row.seen_from_right);
}

bool points_backwards(const Eigen::Vector2d& u) {
  const bool nearly_east = std::abs(u.y()) < std::sin(kNearlyEast);
  return nearly_east ? u.x() < 0 : u.y() < 0;
}

// Mean distance between two rows where they run side by side; nothing where they do not.
std::optional<double> mean_distance(const Row& a, const Row& b) {
  double sum = 0;
  int n = 0;
  for (const auto& p : a.centreline) {
    const LineProjection on_line = project_onto_line(b.centreline, p);
    if (!on_line.inside) continue;
    sum += std::abs(on_line.across_m);
    ++n;
  }
  if (n < 4) return std::nullopt;
  return sum / n;
}

bool same_block(const Row& a, const Row& b) {
  const double turn = std::acos(std::clamp(std::abs(chord(a).dot(chord(b))), 0.0, 1.0));
  if (turn > kSameDirection) return false;
  const auto distance = mean_distance(a, b);
  return distance && *distance < kWidestLane;
}

std::vector<std::vector<std::size_t>> connected_blocks(const std::vector<Row>& rows) {
  std::vector<int> block(rows.size(), -1);
  std::vector<std::vector<std::size_t>> blocks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (block[i] >= 0) continue;
    block[i] = static_cast<int>(blocks.size());
    std::vector<std::size_t> members{i};
    for (std::size_t k = 0; k < members.size(); ++k)
      for (std::size_t j = 0; j < rows.size(); ++j)
        if (block[j] < 0 && same_block(rows[members[k]], rows[j])) block[j] = block[i], members.push_back(j);
    blocks.push_back(std::move(members));
  }
  return blocks;
}

}  // namespace

void number_rows(RowLayout& layout) {
  std::vector<Row>& rows = layout.rows;
  // A fixed order of the input first, so that nothing below depends on how the rows were found.
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    const Eigen::Vector2d p = middle(a), q = middle(b);
    return std::make_tuple(p.x(), p.y()) < std::make_tuple(q.x(), q.y());
  });
  std::vector<Row> ordered;
  for (const auto& block : connected_blocks(rows)) {
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    for (std::size_t i : block) {
      const Eigen::Vector2d u = chord(rows[i]) * rows[i].length_m();
      direction += direction.dot(u) < 0 ? Eigen::Vector2d(-u) : u;
    }
    if (points_backwards(direction.normalized())) direction = -direction;
    direction.normalize();
    std::vector<Row> members;
    for (std::size_t i : block) {
      members.push_back(rows[i]);
      if (chord(members.back()).dot(direction) < 0) reverse(members.back());
    }
    const auto rank = [&](const Row& row) {
      const Eigen::Vector2d p = middle(row);
      return std::make_tuple(p.x() * direction.y() - p.y() * direction.x(), p.dot(direction));
    };
    std::sort(members.begin(), members.end(), [&](const Row& a, const Row& b) { return rank(a) < rank(b); });
    ordered.insert(ordered.end(), members.begin(), members.end());
  }
  rows = std::move(ordered);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].number = static_cast<int>(i) + 1;
  layout.spacing_m = row_spacing(rows);
}

double row_spacing(std::span<const Row> rows) {
  std::vector<double> distances;
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (same_block(rows[i - 1], rows[i])) distances.push_back(*mean_distance(rows[i - 1], rows[i]));
  return median_of(std::move(distances));
}

}  // namespace rayfield::density
