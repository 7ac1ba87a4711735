#include "libdensity/integration/plan_raster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "libdensity/integration/integrate.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct Polygon {
  std::array<Eigen::Vector2d, 16> corner;
  std::size_t count = 0;
};

/// Keeps the side of the line coordinate[axis] = limit on which sign·(coordinate − limit) ≥ 0 (Sutherland & Hodgman).
Polygon cut(const Polygon& in, int axis, double limit, double sign) {
  Polygon out;
  for (std::size_t i = 0; i < in.count; ++i) {
    const Eigen::Vector2d &a = in.corner[i], &b = in.corner[(i + 1) % in.count];
    const double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
    if (da >= 0) out.corner[out.count++] = a;
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) out.corner[out.count++] = a + da / (da - db) * (b - a);
  }
  return out;
}

double polygon_area(const Polygon& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.count; ++i) {
    const Eigen::Vector2d a = p.corner[i] - p.corner[0], b = p.corner[(i + 1) % p.count] - p.corner[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::max(0.0, twice / 2);
}

std::array<Eigen::Vector2d, 4> column_square(const RowDensity& row, int along, int across) {
  const Eigen::Vector2d center = row.center(along, across), u = row.row_segment(along).direction * (row.voxel_m / 2);
  const Eigen::Vector2d v(-u.y(), u.x());
  return {center - u - v, center + u - v, center + u + v, center - u + v};
}

struct Column {
  double area = 0, variance = 0, height = 0;
  bool seen = false, canopy = false;
};

Column column_of(const RowDensity& row, int along, int across, double height_share, std::vector<double>& layers) {
  Column out;
  layers.assign(static_cast<std::size_t>(row.n_up), 0);
  for (int u = 0; u < row.n_up; ++u) {
    out.area += row.plant_area(along, across, u);
    out.variance += row.area_variance(along, across, u);
    out.seen = out.seen || row.state[row.index(along, across, u)] != VoxelState::unobserved;
    layers[u] = row.canopy_area(along, across, u);
  }
  // Masked wood is known wherever it stands, also where no ray could pass.
  out.seen = out.seen || out.area > 0;
  const double top = quantile_height(layers, row.voxel_m, height_share);
  if (std::isfinite(top)) out.canopy = true, out.height = row.up_min_m + top;
  return out;
}

}  // namespace

double overlap_area(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  Polygon p;
  p.count = std::min<std::size_t>(polygon.size(), 8);
  std::copy_n(polygon.begin(), p.count, p.corner.begin());
  for (int axis = 0; axis < 2; ++axis) p = cut(cut(p, axis, low[axis], 1), axis, high[axis], -1);
  return polygon_area(p);
}

Result<PlanRaster> PlanRaster::create(const RasterFrame& frame, std::span<const RowSegment> row_segments,
                                      const PlanRasterOptions& options, std::size_t bytes,
                                      const std::filesystem::path& folder) {
  RAYFIELD_CHECK(options.validate());
  if (row_segments.empty())
    return fail(ErrorCode::bad_input, "cannot make maps", "scan", "it shows none of the block's rows",
                "check its date and place; `rayfield remove` takes it out of the block");
  for (const RowSegment& s : row_segments) {
    const Eigen::Vector2d v(-s.direction.y(), s.direction.x());
    for (const double a : {0.0, s.n_along * s.voxel_m})
      for (const double c : {s.across_min_m, s.across_min_m + s.n_across * s.voxel_m})
        if (!frame.contains(s.origin + a * s.direction + c * v))
          return fail(ErrorCode::internal, "cannot make maps", "row " + std::to_string(s.row),
                      "its voxels reach beyond the block's maps", "please report this");
  }
  return PlanRaster(frame, options, bytes, folder);
}

Result<void> PlanRaster::add_column(const RowDensity& row, int along, int across, std::vector<double>& layers) {
  const double cell = frame_.cell_m, square = row.voxel_m * row.voxel_m;
  const Column column = column_of(row, along, across, options_.height_share, layers);
  if (!column.seen) return {};
  const std::array<Eigen::Vector2d, 4> corners = column_square(row, along, across);
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : corners) box.extend(p);
  const Eigen::Vector2d low = (box.min() - frame_.origin) / cell, high = (box.max() - frame_.origin) / cell;
  const int x0 = std::clamp(floor_int(low.x()), 0, frame_.nx - 1),
            x1 = std::clamp(floor_int(high.x()), 0, frame_.nx - 1);
  const int y0 = std::clamp(floor_int(low.y()), 0, frame_.ny - 1),
            y1 = std::clamp(floor_int(high.y()), 0, frame_.ny - 1);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d corner = frame_.origin + cell * Eigen::Vector2d(x, y);
      const double overlap = overlap_area(corners, corner, corner.array() + cell);
      if (!(overlap > 0)) continue;
      const double share = overlap / square;
      RAYFIELD_ASSIGN(Cell* const out, cells_.at(x, y));
      out->area += share * column.area, out->variance += share * share * column.variance;
      out->seen += overlap;
      if (column.canopy) out->height += overlap * column.height, out->canopy += overlap;
    }
  return {};
}

Result<void> PlanRaster::add(const RowDensity& row) {
  std::vector<double> layers;
  for (int a = 0; a < row.n_along; ++a)
    for (int c = 0; c < row.n_across; ++c) RAYFIELD_CHECK(add_column(row, a, c, layers));
  return {};
}

Result<void> PlanRaster::mark_scanned(const Eigen::Vector2d& p) {
  const Eigen::Vector2d c = (p - frame_.origin) / frame_.cell_m;
  const int ix = floor_int(c.x()), iy = floor_int(c.y());
  if (ix < 0 || iy < 0 || ix >= frame_.nx || iy >= frame_.ny) return {};
  RAYFIELD_ASSIGN(Cell* const cell, cells_.at(ix, iy));
  cell->scanned = true;
  return {};
}

std::vector<RasterProduct> PlanRaster::maps() const {
  Grid2<float> frame(frame_.origin, frame_.cell_m, 0, 0);
  frame.nx = frame_.nx, frame.ny = frame_.ny;
  return {{"plan_density", "m2/m2", "One-sided plant area (leaves, wood, posts, wires) above a square metre of ground",
           frame},
          {"plan_density_se", "m2/m2", "Standard error of plan_density", frame},
          {"canopy_height", "m", "Height above the ground below which 97 % of the plant area of a column lies", frame}};
}

float PlanRaster::value(const Cell& c, std::size_t map) const {
  if (!(c.seen > 0)) return c.scanned ? 0 : kNaN;
  const double cell_area = frame_.cell_m * frame_.cell_m;
  if (map == 0) return static_cast<float>(c.area / cell_area);
  if (map == 1) return static_cast<float>(std::sqrt(c.variance) / cell_area);
  return c.canopy > 0 ? static_cast<float>(c.height / c.canopy) : 0.0F;
}

Result<void> PlanRaster::read(std::size_t map, std::uint64_t first, std::span<float> values) {
  const auto nx = static_cast<std::uint64_t>(frame_.nx), of_band = nx * PagedGrid<Cell>::kSide;
  for (std::size_t done = 0; done < values.size();) {
    const std::uint64_t at = first + done;
    const int number = static_cast<int>(at / of_band);
    if (band_.map != map || band_.number != number) {
      band_.map = map, band_.number = -1;
      band_.values.assign(of_band, kNaN);
      const std::uint64_t begin = static_cast<std::uint64_t>(number) * of_band;
      RAYFIELD_CHECK(cells_.visit_band(number, [&](int ix, int iy, const Cell& cell) {
        band_.values[static_cast<std::uint64_t>(iy) * nx + static_cast<std::uint64_t>(ix) - begin] = value(cell, map);
      }));
      band_.number = number;
    }
    const std::size_t within = at % of_band, part = std::min<std::size_t>(of_band - within, values.size() - done);
    std::copy_n(band_.values.begin() + static_cast<std::ptrdiff_t>(within), part,
                values.begin() + static_cast<std::ptrdiff_t>(done));
    done += part;
  }
  return {};
}

}  // namespace rayfield::density
