#include "rayfield/density/zones.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libdensity/layout/ring_around.h"
#include "libdensity/zones/natural_breaks.h"

namespace rayfield::density {
namespace {

constexpr const char* kWhat = "cannot make zones";
constexpr double kHalfMetre = 0.5;
constexpr double kLoneRowWidth_m = 2.5;
constexpr double kMostCells = 5e7;
/// Where the Gaussian ends, in standard deviations.
constexpr double kReach = 4;

std::vector<double> gaussian(double sigma_cells) {
  std::vector<double> kernel;
  for (int i = 0; i <= std::ceil(kReach * sigma_cells); ++i)
    kernel.push_back(std::exp(-0.5 * i * i / (sigma_cells * sigma_cells)));
  return kernel;
}

// One pass along columns or rows; what lies outside counts nothing.
void blur(Grid2<double>& grid, const std::vector<double>& kernel, bool along_x) {
  const int length = along_x ? grid.nx : grid.ny, lines = along_x ? grid.ny : grid.nx;
  const int reach = static_cast<int>(kernel.size()) - 1;
  std::vector<double> line(static_cast<std::size_t>(length));
  for (int l = 0; l < lines; ++l) {
    const auto cell = [&](int i) -> double& { return along_x ? grid.at(i, l) : grid.at(l, i); };
    for (int i = 0; i < length; ++i) line[static_cast<std::size_t>(i)] = cell(i);
    for (int i = 0; i < length; ++i) {
      double sum = 0;
      for (int k = std::max(0, i - reach); k <= std::min(length - 1, i + reach); ++k)
        sum += kernel[static_cast<std::size_t>(std::abs(k - i))] * line[static_cast<std::size_t>(k)];
      cell(i) = sum;
    }
  }
}

Result<Grid2<double>> frame_of(std::span<const ZoneSample> samples, double margin_m, double cell_m) {
  Eigen::AlignedBox<double, 2> box;
  for (const ZoneSample& sample : samples) box.extend(sample.position);
  const Eigen::Vector2d low = box.min().array() - margin_m, size = box.sizes().array() + 2 * margin_m;
  const Eigen::Vector2d cells = (size / cell_m).array().ceil() + 1;
  if (!(cells.prod() <= kMostCells))
    return fail(ErrorCode::usage, kWhat, "cell_m", fmt::format("the block has {:.0f} cells", cells.prod()),
                "give a larger --set cell_m");
  return Grid2<double>(low, cell_m, static_cast<int>(cells.x()), static_cast<int>(cells.y()));
}

// Weighted means of the samples around each cell. Cells out of the Gaussian's reach take a wider one.
Grid2<double> smoothed(std::span<const ZoneSample> samples, const Grid2<double>& frame, double smoothing_m) {
  Grid2<double> result = frame, weights = frame, sums = frame;
  for (const ZoneSample& sample : samples) {
    const Eigen::Vector2d place = (sample.position - frame.origin) / frame.cell_m;
    const std::size_t i = frame.index(static_cast<int>(place.x()), static_cast<int>(place.y()));
    weights.values[i] += sample.weight, sums.values[i] += sample.weight * sample.value;
  }
  result.values.assign(result.values.size(), std::numeric_limits<double>::quiet_NaN());
  for (bool whole = false; !whole; smoothing_m *= 2) {
    Grid2<double> w = weights, s = sums;
    const std::vector<double> kernel = gaussian(smoothing_m / frame.cell_m);
    for (const bool along_x : {true, false}) blur(w, kernel, along_x), blur(s, kernel, along_x);
    whole = true;
    for (std::size_t i = 0; i < result.values.size(); ++i) {
      if (!std::isnan(result.values[i])) continue;
      if (w.values[i] > 0)
        result.values[i] = s.values[i] / w.values[i];
      else
        whole = false;
    }
  }
  return result;
}

// Whether a point lies inside of a ring: how often a ray to the east crosses it.
bool inside(const std::vector<Eigen::Vector2d>& ring, const Eigen::Vector2d& p) {
  bool in = false;
  for (std::size_t i = 0, k = ring.size() - 1; i < ring.size(); k = i++) {
    const Eigen::Vector2d &a = ring[i], &b = ring[k];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      in = !in;
  }
  return in;
}

bool inside(const ManagementZone& zone, const Eigen::Vector2d& p) {
  return std::any_of(zone.parts.begin(), zone.parts.end(), [&](const ZonePart& part) {
    return inside(part.exterior, p) &&
           std::none_of(part.holes.begin(), part.holes.end(), [&](const auto& hole) { return inside(hole, p); });
  });
}

}  // namespace

Result<void> ZoneOptions::validate() const { return check_option_ranges(*this, "bad zone option"); }

std::vector<ZoneSample> row_samples(const ScanResults& scan) {
  std::vector<ZoneSample> samples;
  for (const RowMetreProduct& metre : scan.row_metres)
    if (std::isfinite(metre.leaf_area_per_m)) samples.push_back({metre.position, metre.leaf_area_per_m, kHalfMetre});
  return samples;
}

std::vector<ZoneSample> map_samples(const Grid2<float>& map, double cell_m) {
  const int step = std::max(1, static_cast<int>(std::lround(cell_m / map.cell_m)));
  std::vector<ZoneSample> samples;
  for (int iy = 0; iy < map.ny; iy += step) {
    for (int ix = 0; ix < map.nx; ix += step) {
      double sum = 0;
      int count = 0;
      Eigen::Vector2d place = Eigen::Vector2d::Zero();
      for (int y = iy; y < std::min(iy + step, map.ny); ++y)
        for (int x = ix; x < std::min(ix + step, map.nx); ++x)
          if (const double value = static_cast<double>(map.at(x, y)); std::isfinite(value))
            sum += value, place += map.center(x, y), ++count;
      if (count > 0) samples.push_back({place / count, sum / count, count * map.cell_m * map.cell_m});
    }
  }
  return samples;
}

std::vector<std::vector<Eigen::Vector2d>> row_bands(std::span<const RowProduct> rows, const std::string& date) {
  std::vector<std::vector<Eigen::Vector2d>> bands;
  for (const RowProduct& row : rows) {
    const bool stands =
        (row.valid_from.empty() || row.valid_from <= date) && (row.valid_to.empty() || date < row.valid_to);
    if (!stands || row.centreline.size() < 2) continue;
    const double half_m = (row.spacing_m > 0 ? row.spacing_m : kLoneRowWidth_m) / 2;
    bands.push_back(ring_around(row.centreline, half_m));
  }
  return bands;
}

double smallest_zone_m2(std::span<const std::vector<Eigen::Vector2d>> bands, const ZoneOptions& options) {
  double area = 0;
  for (const std::vector<Eigen::Vector2d>& band : bands)
    for (std::size_t i = 0; i + 1 < band.size(); ++i) {
      const Eigen::Vector2d a = band[i] - band[0], b = band[i + 1] - band[0];
      area += (a.x() * b.y() - a.y() * b.x()) / 2;
    }
  return std::min(options.min_zone_m2, area / (4 * options.classes));
}

std::vector<ZoneSample> samples_on(std::span<const std::vector<Eigen::Vector2d>> bands,
                                   std::span<const ZoneSample> samples) {
  std::vector<Eigen::AlignedBox<double, 2>> boxes(bands.size());
  for (std::size_t i = 0; i < bands.size(); ++i)
    for (const Eigen::Vector2d& p : bands[i]) boxes[i].extend(p);
  std::vector<ZoneSample> kept;
  for (const ZoneSample& sample : samples) {
    bool on = false;
    for (std::size_t i = 0; i < bands.size() && !on; ++i)
      on = boxes[i].contains(sample.position) && inside(bands[i], sample.position);
    if (on) kept.push_back(sample);
  }
  return kept;
}

Result<ValueSurface> value_surface(std::span<const ZoneSample> samples, double margin_m, const ZoneOptions& options) {
  RAYFIELD_CHECK(options.validate());
  if (samples.empty())
    return fail(ErrorCode::bad_input, kWhat, "", "the scan has no values of that kind", "give another --date or --of");
  RAYFIELD_ASSIGN(const Grid2<double> frame, frame_of(samples, margin_m, options.cell_m));
  ValueSurface surface;
  surface.values = smoothed(samples, frame, options.smoothing_m);
  std::vector<double> values, weights;
  for (const ZoneSample& sample : samples) {
    const Eigen::Vector2d place = (sample.position - frame.origin) / frame.cell_m;
    values.push_back(surface.values.at(static_cast<int>(place.x()), static_cast<int>(place.y())));
    weights.push_back(sample.weight);
  }
  RAYFIELD_ASSIGN(surface.breaks, natural_breaks(values, weights, options.classes));
  return surface;
}

double measure_zones(std::span<const ZoneSample> samples, std::vector<ManagementZone>& zones) {
  constexpr double kNone = std::numeric_limits<double>::infinity(), kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sums(zones.size(), 0);
  double weight = 0, sum = 0, squares = 0;
  const double about = samples.empty() ? 0 : samples.front().value;  // so that squares do not cancel
  for (ManagementZone& zone : zones) zone.measured = 0, zone.min = kNone, zone.max = -kNone;
  for (const ZoneSample& sample : samples) {
    const auto found = std::find_if(zones.begin(), zones.end(),
                                    [&](const ManagementZone& zone) { return inside(zone, sample.position); });
    if (found == zones.end()) continue;  // on the border of the outline
    const double v = sample.value - about;
    sums[static_cast<std::size_t>(found - zones.begin())] += sample.weight * v;
    weight += sample.weight, sum += sample.weight * v, squares += sample.weight * v * v;
    found->measured += sample.weight;
    found->min = std::min(found->min, sample.value), found->max = std::max(found->max, sample.value);
  }
  double between = 0;
  for (std::size_t i = 0; i < zones.size(); ++i) {
    ManagementZone& zone = zones[i];
    zone.mean = zone.measured > 0 ? about + sums[i] / zone.measured : kUnknown;
    if (zone.measured > 0)
      between += sums[i] * sums[i] / zone.measured;
    else
      zone.min = zone.max = kUnknown;
  }
  const double all = squares - sum * sum / weight;
  return all > 0 ? (between - sum * sum / weight) / all : kUnknown;
}

}  // namespace rayfield::density
