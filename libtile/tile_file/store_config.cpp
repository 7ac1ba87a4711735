#include "rayfield/tile/store_config.h"

#include <fmt/core.h>

#include <cmath>

#include "libtile/tile_file/tile_grid.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::tile {
namespace {

constexpr double kLeastTile_m = 5, kLargestTile_m = 10000;

bool whole_units(double metres) {
  return std::isfinite(metres) && std::abs(metres * kUnitsPerMetre - std::round(metres * kUnitsPerMetre)) < 1e-6;
}

}  // namespace

Result<void> StoreConfig::validate() const {
  if (const auto found = lookup_projected_crs(crs); !found) return tl::make_unexpected(found.error());
  if (!whole_units(tile_size_m) || tile_size_m < kLeastTile_m || tile_size_m > kLargestTile_m)
    return fail(ErrorCode::usage, "bad tile size", fmt::format("{} m", tile_size_m),
                fmt::format("it must be {} to {} m and a multiple of 0.1 mm", kLeastTile_m, kLargestTile_m));
  if (!whole_units(tile_margin_m) || tile_margin_m < 0 || tile_margin_m > tile_size_m / 4)
    return fail(ErrorCode::usage, "bad tile margin", fmt::format("{} m", tile_margin_m),
                "it must be 0 to a quarter of the tile size and a multiple of 0.1 mm");
  return {};
}

}  // namespace rayfield::tile
