#include "libdensity/integration/raster_frame.h"

#include <cmath>

#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kGroundMargin_m = 10;
// Voxels reach half the spacing of the rows to the side, those of a lone row RowSegmentOptions::lone_half_width_m, of
// which 3 m is the most; beyond the ends of a row less than one voxel, of at most 0.3 m.
constexpr double kLoneReach_m = 3, kSlack_m = 1;

Result<RasterFrame> frame_of_rows(const RowLayout& layout, double margin_m, double cell_m) {
  Eigen::AlignedBox2d box;
  for (const Row& row : layout.rows)
    for (const Eigen::Vector2d& p : row.centreline) box.extend(p);
  if (!box.isEmpty())
    box = {Eigen::Vector2d(box.min().array() - margin_m), Eigen::Vector2d(box.max().array() + margin_m)};
  return frame_around(box, cell_m);
}

}  // namespace

Result<RasterFrame> frame_around(const Eigen::AlignedBox2d& box, double cell_m) {
  if (box.isEmpty()) return fail(ErrorCode::usage, "cannot make maps", "block", "it has no rows");
  const double step_m = kFrameStep_cells * cell_m;
  const Eigen::Vector2d low = (box.min() / step_m).array().floor(), high = (box.max() / step_m).array().ceil();
  const Eigen::Vector2d steps = (high - low).cwiseMax(1.0);
  if (!(steps.x() * steps.y() * kFrameStep_cells * kFrameStep_cells < 2147483648.0))
    return fail(ErrorCode::resources, "cannot make maps", "block", "more than 2^31 cells", "use a larger cell size");
  // The number of the first cell times its size, as every other corner of a cell, so that frames agree to the last bit.
  return RasterFrame{Eigen::Vector2d(kFrameStep_cells * low) * cell_m, cell_m, kFrameStep_cells * round_int(steps.x()),
                     kFrameStep_cells * round_int(steps.y())};
}

Result<RasterFrame> plan_frame(const RowLayout& layout, double cell_m) {
  // fmax: the spacing of a single row is NaN.
  return frame_of_rows(layout, std::fmax(kLoneReach_m, layout.spacing_m / 2) + kSlack_m, cell_m);
}

Result<RasterFrame> ground_frame(const RowLayout& layout, double cell_m) {
  return frame_of_rows(layout, kGroundMargin_m, cell_m);
}

Result<FittedMap> FittedMap::create(const Grid2<float>& map, const RasterFrame& frame) {
  const Eigen::Vector2d shift = (map.origin - frame.origin) / frame.cell_m;
  const Eigen::Vector2d whole = shift.array().round();
  if (std::abs(map.cell_m - frame.cell_m) > 1e-9 * frame.cell_m || !((shift - whole).cwiseAbs().maxCoeff() < 1e-3))
    return fail(ErrorCode::usage, "cannot lay maps upon each other", "block", "their cells differ",
                "run `rayfield process` so that all dates are mapped alike");
  FittedMap fitted;
  fitted.frame_ = frame;
  fitted.dx_ = round_int(whole.x()), fitted.dy_ = round_int(whole.y());
  fitted.nx_ = map.nx, fitted.ny_ = map.ny;
  return fitted;
}

}  // namespace rayfield::density
