#include "formats/report/packed_grid.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "formats/io/base64.h"

namespace rayfield::formats {

int packed_level(float value, double high) {
  if (!std::isfinite(value)) return 0;
  const double t = std::clamp(static_cast<double>(value) / high, 0.0, 1.0);
  return 1 + static_cast<int>(std::lround(t * (kPackedLevels - 1)));
}

Result<std::string> packed_grid(const Grid2<float>& grid, double high) {
  std::vector<Bytef> levels;
  levels.reserve(grid.values.size());
  for (int y = grid.ny - 1; y >= 0; --y)
    for (int x = 0; x < grid.nx; ++x) levels.push_back(static_cast<Bytef>(packed_level(grid.at(x, y), high)));
  uLongf size = compressBound(static_cast<uLong>(levels.size()));
  std::vector<Bytef> packed(size);
  if (compress2(packed.data(), &size, levels.data(), static_cast<uLong>(levels.size()), Z_BEST_COMPRESSION) != Z_OK)
    return fail(ErrorCode::resources, "cannot write report", "", "out of memory", "close other programs");
  packed.resize(size);
  return base64(std::as_bytes(std::span(packed)));
}

}  // namespace rayfield::formats
