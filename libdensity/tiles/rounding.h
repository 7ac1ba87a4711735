#pragma once

#include <cmath>

namespace rayfield::density {

/// Whole numbers from lengths in cells. The value has to fit: callers bound it before.
inline int floor_int(double value) { return static_cast<int>(std::floor(value)); }
inline int ceil_int(double value) { return static_cast<int>(std::ceil(value)); }
inline int round_int(double value) { return static_cast<int>(std::lround(value)); }

}  // namespace rayfield::density
