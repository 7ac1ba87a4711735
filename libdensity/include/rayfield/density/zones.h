#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/option_fields.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/zone_products.h"

/// zones: management zones of a block by natural breaks (docs/farm-systems.md, "Management zones").
namespace rayfield::density {

struct ZoneOptions {
  int classes = 3;
  double smoothing_m = 5;
  double cell_m = 1;
  double min_zone_m2 = 200;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.integer("classes", o.classes, {2, 5}, "Classes of the smoothed values, and so zones at most");
    v.number("smoothing_m", o.smoothing_m, {0.5, 50},
             "Standard deviation of the Gaussian that smooths values in plan; larger = fewer and rounder zones");
    v.number("cell_m", o.cell_m, {0.2, 10}, "Cells of the smoothed surface that borders are drawn on");
    v.number(
        "min_zone_m2", o.min_zone_m2, {0, 1e6},
        "Smaller parts join the neighbour with which they share the longest border; on small blocks a quarter of a "
        "zone's mean area, if that is less");
  }
  Result<void> validate() const;
};

/// A measured value and its place.
struct ZoneSample {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double value = 0;
  double weight = 0;  ///< metres of row, or m² of ground
};

/// Leaf area per metre of row of every half metre of a scan that has one; weights in m.
std::vector<ZoneSample> row_samples(const ScanResults& scan);

/// Means of a map's cells over squares of `cell_m`; cells without a value are left out. Weights in m².
std::vector<ZoneSample> map_samples(const Grid2<float>& map, double cell_m);

/// Ground that belongs to the rows that stand on a date: each row's centreline, half the row spacing to either side
/// (a single row: 1.25 m). One closed ring per row, counter-clockwise.
std::vector<std::vector<Eigen::Vector2d>> row_bands(std::span<const RowProduct> rows, const std::string& date);

/// min_zone_m2, or on small blocks a quarter of the mean area of a zone.
double smallest_zone_m2(std::span<const std::vector<Eigen::Vector2d>> bands, const ZoneOptions& options);

/// The samples that lie on such ground: what a map shows of headlands would pull the block's edges to zero.
std::vector<ZoneSample> samples_on(std::span<const std::vector<Eigen::Vector2d>> bands,
                                   std::span<const ZoneSample> samples);

/// Values smoothed in plan, and where to cut them.
struct ValueSurface {
  Grid2<double> values;        ///< every cell has one, also beyond the samples
  std::vector<double> breaks;  ///< between classes, rising
};

/// Smooths samples with a Gaussian (weighted means, so that borders pull nowhere) over the samples' extent and
/// `margin_m` around it, and cuts the smoothed values at the samples into classes by natural breaks: the classes with
/// the least variance inside (W. D. Fisher, On grouping for maximum homogeneity, J. Am. Stat. Assoc. 53, 1958; Jenks,
/// 1967), which is the optimum that k-means seeks, found exactly.
/// Errors: usage (options, more than 50 million cells), bad_input (fewer different values than classes).
Result<ValueSurface> value_surface(std::span<const ZoneSample> samples, double margin_m, const ZoneOptions& options);

/// Fills mean, min, max and `measured` of zones from the samples that lie in them, and returns the share of the
/// samples' variance that lies between zones, 0 … 1 (NaN where there is none).
double measure_zones(std::span<const ZoneSample> samples, std::vector<ManagementZone>& zones);

}  // namespace rayfield::density
