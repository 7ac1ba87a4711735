#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "libdensity/integration/plan_raster.h"

namespace rayfield::density::testing {

inline constexpr std::size_t kAllInMemory = std::size_t{1} << 30;

inline std::filesystem::path scratch() { return std::filesystem::temp_directory_path(); }

/// All values of one map, read in parts of an odd length.
inline std::vector<float> values_of(PlanRaster& raster, std::size_t map) {
  const Grid2<float> grid = raster.maps()[map].grid;
  std::vector<float> values(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny));
  constexpr std::size_t kPart = 10007;
  for (std::size_t first = 0; first < values.size(); first += kPart)
    EXPECT_TRUE(raster.read(map, first, std::span(values).subspan(first, std::min(kPart, values.size() - first))));
  return values;
}

}  // namespace rayfield::density::testing
