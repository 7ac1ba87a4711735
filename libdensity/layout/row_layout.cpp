#include "libdensity/layout/row_layout.h"

#include "libdensity/layout/polyline.h"

namespace rayfield::density {

double Row::length_m() const { return polyline_length(centreline); }

}  // namespace rayfield::density
