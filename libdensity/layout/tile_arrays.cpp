#include <algorithm>
#include <array>
#include <limits>

#include "libdensity/tiles/stored.h"
#include "rayfield/density/layout_arrays.h"

namespace rayfield::density {
namespace {

constexpr std::array<const char*, 3> kLayers{"stem", "canopy", "tall"};

}  // namespace

tile::ArraySet stems_to_arrays(std::span<const Stem> stems) {
  tile::ArraySet out;
  out.kind = "stems", out.version = 1, out.attributes = nlohmann::json{{"unit", "m"}}.dump();
  std::vector<std::int32_t> row;
  std::array<std::vector<double>, 9> numbers;
  for (const Stem& s : stems) {
    row.push_back(s.row);
    const std::array<double, 9> values{s.position.x(), s.position.y(), s.lean.x(),    s.lean.y(), s.radius_m,
                                       s.top_m,        s.contrast,     s.upper_share, s.solidity};
    for (std::size_t k = 0; k < values.size(); ++k) numbers[k].push_back(values[k]);
  }
  constexpr std::array<const char*, 9> kNames{"easting_m", "northing_m", "lean_east",   "lean_north", "radius_m",
                                              "top_m",     "contrast",   "upper_share", "solidity"};
  out.columns["row"] = std::move(row);
  for (std::size_t k = 0; k < kNames.size(); ++k) out.columns[kNames[k]] = std::move(numbers[k]);
  return out;
}

Result<std::vector<Stem>> stems_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_CHECK(stored_attributes(arrays, "stems", 1));
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("row"));
  const std::size_t n = row.size();
  RAYFIELD_ASSIGN(const auto east, stored_column<double>(arrays, "easting_m", n));
  RAYFIELD_ASSIGN(const auto north, stored_column<double>(arrays, "northing_m", n));
  RAYFIELD_ASSIGN(const auto lean_east, stored_column<double>(arrays, "lean_east", n));
  RAYFIELD_ASSIGN(const auto lean_north, stored_column<double>(arrays, "lean_north", n));
  RAYFIELD_ASSIGN(const auto radius, stored_column<double>(arrays, "radius_m", n));
  RAYFIELD_ASSIGN(const auto top, stored_column<double>(arrays, "top_m", n));
  RAYFIELD_ASSIGN(const auto contrast, stored_column<double>(arrays, "contrast", n));
  RAYFIELD_ASSIGN(const auto upper, stored_column<double>(arrays, "upper_share", n));
  RAYFIELD_ASSIGN(const auto solidity, stored_column<double>(arrays, "solidity", n));
  std::vector<Stem> stems;
  for (std::size_t i = 0; i < n; ++i)
    stems.push_back({row[i],
                     {east[i], north[i]},
                     {lean_east[i], lean_north[i]},
                     radius[i],
                     top[i],
                     contrast[i],
                     upper[i],
                     solidity[i]});
  return stems;
}

tile::ArraySet canopy_to_arrays(const CanopyTile& tile) {
  tile::ArraySet out;
  out.kind = "canopy", out.version = 1;
  const auto& first = tile.layers[0];
  out.attributes = nlohmann::json{
      {"easting_m", first.origin.x()},
      {"northing_m", first.origin.y()},
      {"cell_m", first.cell_m},
      {"cells",
       first.nx}}.dump();
  for (std::size_t l = 0; l < kLayers.size(); ++l) out.columns[kLayers[l]] = tile.layers[l].values;
  return out;
}

Result<CanopyTile> canopy_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const nlohmann::json json, stored_attributes(arrays, "canopy", 1));
  RAYFIELD_ASSIGN(const double east, stored_number(arrays, json, "easting_m"));
  RAYFIELD_ASSIGN(const double north, stored_number(arrays, json, "northing_m"));
  RAYFIELD_ASSIGN(const double cell_m, stored_number(arrays, json, "cell_m"));
  RAYFIELD_ASSIGN(const int n, stored_count(arrays, json, "cells", 1, 20000));
  if (!(cell_m > 0)) return damaged(arrays, "the cell size is not positive");
  CanopyTile tile;
  for (std::size_t l = 0; l < kLayers.size(); ++l) {
    RAYFIELD_ASSIGN(
        const auto counts,
        stored_column<std::uint8_t>(arrays, kLayers[l], static_cast<std::size_t>(n) * static_cast<std::size_t>(n)));
    tile.layers[l] = Grid2<std::uint8_t>({east, north}, cell_m, n, n);
    tile.layers[l].values.assign(counts.begin(), counts.end());
  }
  return tile;
}

}  // namespace rayfield::density
