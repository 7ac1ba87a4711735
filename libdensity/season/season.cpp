#include "rayfield/density/season.h"

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "libdensity/integration/interval.h"
#include "libdensity/season/value_error.h"

namespace rayfield::density {
namespace {

// Sums over panels, and the sums of their errors.
struct Sum {
  SeasonValue value;
  double own_squared = 0, shared = 0;

  void add(const PanelProduct& panel, const PanelValue* measured) {
    ++value.panels;
    if (measured == nullptr || !std::isfinite(measured->leaf_area_m2)) return;
    ++value.panels_seen;
    value.length_m += panel.length_m;
    value.leaf_area_m2 += measured->leaf_area_m2, value.plant_area_m2 += measured->plant_area_m2;
    const ValueError error = error_of(*measured);
    own_squared += error.own * error.own, shared += error.shared;
  }

  SeasonValue finish(int row, const ScanProduct& scan) {
    value.row_number = row, value.scan_id = scan.scan_id, value.scan_date = scan.scan_date;
    if (value.panels_seen == 0) value.leaf_area_m2 = value.plant_area_m2 = std::numeric_limits<double>::quiet_NaN();
    const double half = kNormal95 * std::sqrt(own_squared + shared * shared) / value.length_m;
    value.leaf_area_per_m = value.leaf_area_m2 / value.length_m;
    value.plant_area_per_m = value.plant_area_m2 / value.length_m;
    value.ci_low_per_m = value.leaf_area_per_m - half, value.ci_high_per_m = value.leaf_area_per_m + half;
    return value;
  }
};

}  // namespace

std::vector<SeasonValue> season_values(const BlockProducts& block) {
  std::vector<SeasonValue> out;
  for (const ScanResults& scan : block.scans) {
    std::map<std::string, const PanelValue*> measured;
    for (const PanelValue& value : scan.panel_values) measured[value.panel_uid] = &value;
    std::map<int, Sum> sums;
    for (const RowProduct& row : block.rows) sums[row.row_number];
    for (const PanelProduct& panel : block.panels) {
      const auto found = measured.find(panel.panel_uid);
      const PanelValue* value = found == measured.end() ? nullptr : found->second;
      sums[0].add(panel, value), sums[panel.row_number].add(panel, value);
    }
    for (auto& [row, sum] : sums) out.push_back(sum.finish(row, scan.scan));
  }
  return out;
}

}  // namespace rayfield::density
