#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "rayfield/core/products.h"

/// Management zones of a block, as plain values: computed by libdensity, drawn and written by formats. Map
/// coordinates are easting and northing in the store's CRS, m.
namespace rayfield {

/// A polygon: rings are closed, the exterior counter-clockwise, holes clockwise.
struct ZonePart {
  std::vector<Eigen::Vector2d> exterior;
  std::vector<std::vector<Eigen::Vector2d>> holes;
};

/// The part of a block whose smoothed values fall into one class. Zones of a block share borders and do not overlap.
struct ManagementZone {
  int zone = 0;              ///< 1, 2, 3 …, the lowest values first
  double low = 0, high = 0;  ///< bounds of the class; −∞ and ∞ at both ends
  std::vector<ZonePart> parts;
  double area_m2 = 0;
  // Of the values as measured, not smoothed; NaN where the zone holds none.
  double mean = 0, min = 0, max = 0;
  double measured = 0;  ///< what the mean is taken over: metres of row, or m² of ground
};

struct ZoneMap {
  std::string block, farm, variety, crs;
  std::uint64_t snapshot = 0;
  ScanProduct scan;
  std::string value, unit, meaning;  ///< "leaf_area_per_m", "m2/m"
  double explained = 0;  ///< share of the variance of the values as measured that lies between zones, 0 … 1
  double area_m2 = 0;    ///< of the block
  std::vector<ManagementZone> zones;
};

/// A rate for every zone, as the user gave it.
struct Prescription {
  std::string product;        ///< name of what is applied
  std::string unit;           ///< "l/ha"
  std::vector<double> rates;  ///< by zone, from zone 1
};

}  // namespace rayfield
