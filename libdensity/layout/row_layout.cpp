#include "libdensity/layout/row_layout.h"

#include "libdensity/layout/polyline.h"

namespace rayfield::density {

double Row::length_m() const { return polyline_length(centreline); }

std::vector<Panel> panels_of(const RowLayout& layout, int row) {
  std::vector<Panel> panels;
  for (const Panel& panel : layout.panels)
    if (panel.row == row) panels.push_back(panel);
  return panels;
}

}  // namespace rayfield::density
