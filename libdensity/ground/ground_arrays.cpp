#include "libdensity/ground/ground_arrays.h"

#include <cmath>
#include <limits>
#include <utility>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {

tile::ArraySet ground_to_arrays(tile::TileIndex index, const GroundTile& ground) {
  tile::ArraySet out;
  out.kind = "ground", out.version = 1;
  nlohmann::json json{{"ix", index.ix},
                      {"iy", index.iy},
                      {"nodes", ground.nodes.nx},
                      {"cell_m", ground.nodes.cell_m},
                      {"candidates", ground.candidates},
                      {"known_nodes", ground.known_nodes},
                      {"unknown_reason", ground.unknown_reason},
                      {"unit", "m"}};
  json["median_lift_m"] = std::isfinite(ground.median_lift_m) ? nlohmann::json(ground.median_lift_m) : nlohmann::json();
  out.attributes = json.dump();
  out.columns["height_m"] = ground.nodes.values;
  return out;
}

Result<std::pair<tile::TileIndex, GroundTile>> ground_from_arrays(const tile::ArraySet& arrays) {
  constexpr int kMostNodes = 10000, kIndex = std::numeric_limits<int>::max();
  RAYFIELD_ASSIGN(const nlohmann::json json, stored_attributes(arrays, "ground", 1));
  tile::TileIndex index;
  RAYFIELD_ASSIGN(index.ix, stored_count(arrays, json, "ix", -kIndex, kIndex));
  RAYFIELD_ASSIGN(index.iy, stored_count(arrays, json, "iy", -kIndex, kIndex));
  RAYFIELD_ASSIGN(const int n, stored_count(arrays, json, "nodes", 2, kMostNodes));
  RAYFIELD_ASSIGN(const double cell_m, stored_number(arrays, json, "cell_m"));
  if (!(cell_m > 0)) return damaged(arrays, "the cell size is not positive");
  RAYFIELD_ASSIGN(const auto heights,
                  stored_column<float>(arrays, "height_m", static_cast<std::size_t>(n) * static_cast<std::size_t>(n)));
  GroundTile ground;
  ground.nodes = Grid2<float>(Eigen::Vector2d(index.ix, index.iy) * (cell_m * (n - 1)), cell_m, n, n);
  ground.nodes.values.assign(heights.begin(), heights.end());
  RAYFIELD_ASSIGN(ground.candidates, stored_count(arrays, json, "candidates", 0, kIndex));
  RAYFIELD_ASSIGN(ground.known_nodes, stored_count(arrays, json, "known_nodes", 0, n * n));
  const auto lift = json.find("median_lift_m");
  ground.median_lift_m =
      lift != json.end() && lift->is_number() ? lift->get<double>() : std::numeric_limits<double>::quiet_NaN();
  const auto reason = json.find("unknown_reason");
  if (reason != json.end() && reason->is_string()) ground.unknown_reason = reason->get<std::string>();
  return std::make_pair(index, std::move(ground));
}

}  // namespace rayfield::density
