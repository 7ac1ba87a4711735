#include "sim/vines/canopy_sums.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/vines/area_sums.h"

namespace rayfield::sim {
namespace {

constexpr double kStep = 0.02;   // m, between lines and of the sums by height and across
constexpr double kBand = 0.05;   // m, of a profile
constexpr double kPiece = 0.02;  // m, side of the pieces into which triangles are cut for the sums
constexpr double kHeightShare = 0.97, kWidthShare = 0.96, kGapAreaShare = 0.2;
constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

std::size_t cell_of(double value, std::size_t count) {
  return static_cast<std::size_t>(std::clamp(std::floor(value / kStep), 0.0, static_cast<double>(count) - 1));
}

// Where `share` of the area lies before, linear inside a cell.
double quantile(const std::vector<double>& areas, double share) {
  double total = 0, before = 0;
  for (const double area : areas) total += area;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (areas[i] > 0 && before + areas[i] >= share * total)
      return kStep * (static_cast<double>(i) + (share * total - before) / areas[i]);
    before += areas[i];
  }
  return kStep * static_cast<double>(areas.size());
}

// The heights at which the line at chainage `along` enters and leaves the triangle; false where it does not. Edges are
// half open, so that what two triangles share is met once.
bool crossing(const std::array<Eigen::Vector3d, 3>& corners, double along, double& low, double& high) {
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % 3];
    if ((a.x() <= along) == (b.x() <= along)) continue;
    const double height = a.z() + (along - a.x()) / (b.x() - a.x()) * (b.z() - a.z());
    (count++ == 0 ? low : high) = height;
  }
  if (low > high) std::swap(low, high);
  return count == 2;
}

}  // namespace

struct CanopySums::LineSums {
  double lines = 0, open = 0, leaves = 0, elements = 0, outer = 0;
  void put(CanopyTruth& truth) const {
    if (lines > 0) truth.porosity = open / lines;
    if (lines > 0) truth.leaf_layer_number = leaves / lines, truth.canopy_layer_number = elements / lines;
    if (leaves > 0) truth.exposed_leaf_share = outer / leaves;
  }
};

CanopySums::CanopySums(const Ground& ground, int row) : ground_(ground), row_(row) {
  const Site& site = ground.site;
  const double top_m = std::max(site.canopy.top_m, site.structure.cordon_height_m + site.structure.cane_length_m) + 1;
  heights_ = static_cast<std::size_t>(std::ceil(top_m / kStep));
  acrosses_ = static_cast<std::size_t>(std::ceil((site.rows.spacing_m + site.canopy.width_m) / kStep));
  lines_ = static_cast<std::size_t>(std::floor(site.rows.length_m / kStep));
  panels_ = make_stretches(site.rows.panel_length_m);
  metres_ = make_stretches(kMetreStep);
  for (Stretch& panel : panels_)
    for (int band = 0; band * kBand < top_m; ++band) panel.profile.push_back({band * kBand, (band + 1) * kBand});
  leaves_.assign(lines_ * heights_, 0), wood_ = leaves_;
}

std::vector<CanopySums::Stretch> CanopySums::make_stretches(double step_m) const {
  const double length_m = ground_.site.rows.length_m;
  const int count = std::max(1, static_cast<int>(std::ceil(length_m / step_m - 1e-6)));
  std::vector<Stretch> stretches;
  for (int i = 0; i < count; ++i) {
    stretches.push_back({i * step_m, std::min(length_m, (i + 1) * step_m)});
    stretches.back().by_height.assign(heights_, 0), stretches.back().by_across.assign(acrosses_, 0);
  }
  return stretches;
}

CanopySums::Corners CanopySums::corners_of(const TriangleMesh& mesh, std::size_t index) const {
  Corners corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d p = mesh.vertices[mesh.triangles[index][i]].cast<double>();
    const BlockGeometry::RowPosition at = ground_.block.row_position(row_, p.head<2>());
    const double ground_m = ground_.terrain.smooth_height(ground_.block.row_point(row_, at.chainage));
    corners[i] = {at.chainage, at.offset, p.z() - ground_m};
  }
  return corners;
}

void CanopySums::add_to(Stretch& stretch, const Eigen::Vector3d& place, double area, bool is_leaf) const {
  if (!stretch.profile.empty() && (is_leaf || place.z() >= kWoodFromHeight)) {
    const double last = static_cast<double>(stretch.profile.size()) - 1;
    CanopyBand& band = stretch.profile[static_cast<std::size_t>(std::clamp(std::floor(place.z() / kBand), 0.0, last))];
    (is_leaf ? band.leaf_m2 : band.wood_m2) += area;
  }
  if (place.z() < kWoodFromHeight) return;
  stretch.area_m2 += area;
  stretch.by_height[cell_of(place.z(), heights_)] += area;
  stretch.by_across[cell_of(place.y() + kStep * static_cast<double>(acrosses_) / 2, acrosses_)] += area;
}

void CanopySums::add_area(const Corners& corners, double factor, bool is_leaf) {
  const Eigen::Vector3d u = corners[1] - corners[0], v = corners[2] - corners[0];
  const double longest = std::max({u.norm(), v.norm(), (v - u).norm()});
  const int cuts = std::clamp(static_cast<int>(std::ceil(longest / kPiece)), 1, 50);
  const double area = factor * 0.5 * u.cross(v).norm() / (cuts * cuts);
  const auto stretch_at = [](std::vector<Stretch>& stretches, double along) -> Stretch& {
    const auto next = std::upper_bound(stretches.begin() + 1, stretches.end(), along,
                                       [](double value, const Stretch& s) { return value < s.from_m; });
    return *(next - 1);
  };
  // Pieces alike the triangle, every second one upside down.
  for (int i = 0; i < cuts; ++i)
    for (int j = 0; i + j < cuts; ++j)
      for (int upside_down = 0; upside_down <= (i + j + 1 < cuts ? 1 : 0); ++upside_down) {
        const double third = upside_down == 0 ? 1.0 / 3 : 2.0 / 3;
        const Eigen::Vector3d place = corners[0] + (i + third) / cuts * u + (j + third) / cuts * v;
        add_to(stretch_at(panels_, place.x()), place, area, is_leaf);
        add_to(stretch_at(metres_, place.x()), place, area, is_leaf);
      }
}

void CanopySums::add_meetings(const Corners& corners, std::vector<std::uint16_t>& meetings) const {
  const auto [from, to] = std::minmax({corners[0].x(), corners[1].x(), corners[2].x()});
  const auto first = static_cast<std::int64_t>(std::max(0.0, std::floor(from / kStep - 0.5)));
  const auto last = std::min(static_cast<std::int64_t>(lines_) - 1, static_cast<std::int64_t>(std::ceil(to / kStep)));
  for (std::int64_t i = first; i <= last; ++i) {
    double low = 0, high = 0;
    if (!crossing(corners, (static_cast<double>(i) + 0.5) * kStep, low, high)) continue;
    const auto begin = static_cast<std::int64_t>(std::max(0.0, std::ceil(low / kStep - 0.5)));
    const auto end =
        std::min(static_cast<std::int64_t>(heights_), static_cast<std::int64_t>(std::ceil(high / kStep - 0.5)));
    for (std::int64_t k = begin; k < end; ++k)
      ++meetings[static_cast<std::size_t>(i) * heights_ + static_cast<std::size_t>(k)];
  }
}

void CanopySums::add_leaves(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners corners = corners_of(mesh, i);
    add_area(corners, 1, true);
    add_meetings(corners, leaves_);
  }
}

void CanopySums::add_wood(const TriangleMesh& mesh, const TriangleRange& range) {
  for (std::size_t i = range.first; i < range.last; ++i) {
    const Corners corners = corners_of(mesh, i);
    add_area(corners, 0.5, false);
    add_meetings(corners, wood_);
  }
}

// Without what lines meet.
CanopyTruth CanopySums::edges_of(const Stretch& stretch) const {
  CanopyTruth truth{kUndefined, 0, 0, 0, kUndefined, kUndefined, kUndefined, kUndefined};
  if (!(stretch.area_m2 > 0)) return truth;
  truth.base_m = quantile(stretch.by_height, 1 - kHeightShare);
  truth.height_m = quantile(stretch.by_height, kHeightShare);
  truth.width_m =
      quantile(stretch.by_across, 0.5 + kWidthShare / 2) - quantile(stretch.by_across, 0.5 - kWidthShare / 2);
  return truth;
}

void CanopySums::add_lines(const CanopyTruth& outline, std::size_t line, LineSums& sums) const {
  for (std::size_t k = 0; k < heights_; ++k) {
    const double height = (static_cast<double>(k) + 0.5) * kStep;
    if (height < outline.base_m || height > outline.height_m) continue;
    const int leaves = leaves_[line * heights_ + k], wood = (wood_[line * heights_ + k] + 1) / 2;
    sums.lines += 1, sums.open += leaves + wood == 0 ? 1 : 0;
    sums.leaves += leaves, sums.elements += leaves + wood, sums.outer += std::min(leaves, 2);
  }
}

RowCanopy CanopySums::finish() const {
  RowCanopy canopy;
  std::vector<double> areas;
  for (const Stretch& metre : metres_) areas.push_back(metre.area_m2 / (metre.to_m - metre.from_m));
  std::vector<double> sorted = areas;
  std::sort(sorted.begin(), sorted.end());
  const double least = kGapAreaShare * sorted[(3 * sorted.size() + 3) / 4 - 1];
  for (std::size_t i = 0; i < metres_.size(); ++i) {
    canopy.metres.push_back(edges_of(metres_[i]));
    if (areas[i] > 0 && areas[i] >= least) continue;
    canopy.metres.back() = {kUndefined, 0, 0, 1, kUndefined, kUndefined, kUndefined, kUndefined};
  }
  std::vector<LineSums> of_metres(metres_.size());
  std::size_t line = 0;
  for (const Stretch& panel : panels_) {
    CanopyTruth truth = edges_of(panel);
    LineSums of_panel;
    double lines = 0, gaps = 0;
    for (; line < lines_ && (static_cast<double>(line) + 0.5) * kStep < panel.to_m; ++line) {
      const double along = (static_cast<double>(line) + 0.5) * kStep;
      const std::size_t metre = std::min(metres_.size() - 1, static_cast<std::size_t>(along / kMetreStep));
      lines += 1, gaps += canopy.metres[metre].row_gap_share;
      if (canopy.metres[metre].row_gap_share > 0) continue;
      add_lines(canopy.metres[metre], line, of_panel);
      add_lines(canopy.metres[metre], line, of_metres[metre]);
    }
    truth.row_gap_share = gaps / lines;
    of_panel.put(truth);
    canopy.panels.push_back(truth);
    canopy.profiles.push_back(panel.profile);
  }
  for (std::size_t i = 0; i < metres_.size(); ++i) of_metres[i].put(canopy.metres[i]);
  return canopy;
}

}  // namespace rayfield::sim
