#include "rayfield/density/comparison.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libdensity/integration/interval.h"
#include "libdensity/season/paired_statistics.h"
#include "libdensity/season/value_error.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kWhat = "cannot compare dates";

std::map<std::string, const PanelValue*> by_panel(const ScanResults& scan) {
  std::map<std::string, const PanelValue*> out;
  for (const PanelValue& value : scan.panel_values) out[value.panel_uid] = &value;
  return out;
}

// A panel of which the scan says nothing.
PanelValue unseen(const PanelProduct& panel, const ScanProduct& scan) {
  PanelValue v;
  v.panel_uid = panel.panel_uid, v.scan_id = scan.scan_id, v.scan_date = scan.scan_date;
  v.plant_area_m2 = v.leaf_area_m2 = v.leaf_area_per_m = v.lai = kNaN;
  v.se_leaf_area_m2 = v.se_plant_area_m2 = v.plant_ci_low_m2 = v.plant_ci_high_m2 = kNaN;
  v.ci_low_m2 = v.ci_high_m2 = v.canopy_height_m = v.canopy_width_m = v.gap_fraction = kNaN;
  return v;
}

// A change with its standard error. Without any error (nothing there on both dates) nothing changed.
struct TestedChange {
  double low, high, p_value;
  ChangeVerdict verdict;
};
TestedChange test_change(double change, double se) {
  TestedChange out{change - kNormal95 * se, change + kNormal95 * se, 1, ChangeVerdict::none};
  if (change == 0) return out;
  out.p_value = std::erfc(std::abs(change) / se / std::sqrt(2.0));
  if (out.low > 0) out.verdict = ChangeVerdict::gain;
  if (out.high < 0) out.verdict = ChangeVerdict::loss;
  return out;
}

double variance_of_change(const ValueError& a, const ValueError& b, double correlation) {
  return a.own * a.own + b.own * b.own + a.shared * a.shared + b.shared * b.shared -
         2 * correlation * a.shared * b.shared;
}

void take_change(PanelChange& change, double correlation) {
  change.leaf_change_m2 = change.b.leaf_area_m2 - change.a.leaf_area_m2;
  change.plant_change_m2 = change.b.plant_area_m2 - change.a.plant_area_m2;
  change.leaf_change_per_m = change.leaf_change_m2 / change.length_m;
  change.leaf_change_percent = change.a.leaf_area_m2 > 0 ? 100 * change.leaf_change_m2 / change.a.leaf_area_m2 : kNaN;
  change.se_change_m2 = std::sqrt(variance_of_change(error_of(change.a), error_of(change.b), correlation));
  const TestedChange tested = test_change(change.leaf_change_m2, change.se_change_m2);
  change.ci_low_m2 = tested.low, change.ci_high_m2 = tested.high;
  change.p_value = tested.p_value, change.verdict = tested.verdict;
}

void take_nothing(PanelChange& change) {
  change.leaf_change_m2 = change.plant_change_m2 = change.leaf_change_per_m = change.leaf_change_percent = kNaN;
  change.se_change_m2 = change.ci_low_m2 = change.ci_high_m2 = change.p_value = kNaN;
  change.verdict = ChangeVerdict::not_seen;
}

TotalChange total_of(const std::vector<PanelChange>& panels, double correlation) {
  TotalChange total;
  double own = 0;
  ValueError a, b;  // the shared ones add up
  for (const PanelChange& panel : panels) {
    if (panel.verdict == ChangeVerdict::not_seen) continue;
    total.area_a_m2 += panel.a.leaf_area_m2, total.area_b_m2 += panel.b.leaf_area_m2;
    const ValueError of_a = error_of(panel.a), of_b = error_of(panel.b);
    own += of_a.own * of_a.own + of_b.own * of_b.own;
    a.shared += of_a.shared, b.shared += of_b.shared;
  }
  total.change_m2 = total.area_b_m2 - total.area_a_m2;
  total.se_m2 = std::sqrt(own + variance_of_change(a, b, correlation));
  const TestedChange tested = test_change(total.change_m2, total.se_m2);
  total.ci_low_m2 = tested.low, total.ci_high_m2 = tested.high, total.verdict = tested.verdict;
  return total;
}

struct Pairs {
  std::vector<double> a, b;
  PairedStatistics statistics() const { return paired_statistics(a, b); }
};

void compare_panels(DateComparison& out) {
  Pairs leaf, plant;
  for (const PanelChange& panel : out.panels) {
    if (panel.verdict == ChangeVerdict::not_seen) continue;
    leaf.a.push_back(panel.a.leaf_area_m2 / panel.length_m), leaf.b.push_back(panel.b.leaf_area_m2 / panel.length_m);
    plant.a.push_back(panel.a.plant_area_m2 / panel.length_m);
    plant.b.push_back(panel.b.plant_area_m2 / panel.length_m);
  }
  out.leaf_per_m = leaf.statistics(), out.plant_per_m = plant.statistics();
}

void compare_half_metres(const ScanResults& a, const ScanResults& b, DateComparison& out) {
  const auto place = [](const RowMetreProduct& m) { return std::pair(m.row_number, std::lround(1000 * m.chainage_m)); };
  std::map<std::pair<int, long>, const RowMetreProduct*> earlier;
  for (const RowMetreProduct& m : a.row_metres) earlier[place(m)] = &m;
  Pairs leaf, plant;
  for (const RowMetreProduct& m : b.row_metres) {
    const auto found = earlier.find(place(m));
    if (found == earlier.end()) continue;
    leaf.a.push_back(found->second->leaf_area_per_m), leaf.b.push_back(m.leaf_area_per_m);
    plant.a.push_back(found->second->plant_area_per_m), plant.b.push_back(m.plant_area_per_m);
  }
  out.half_metre_leaf_per_m = leaf.statistics(), out.half_metre_plant_per_m = plant.statistics();
}

}  // namespace

Result<void> ComparisonOptions::validate() const { return check_option_ranges(*this, "bad comparison option"); }

Result<DateComparison> compare_dates(const BlockProducts& block, std::size_t a, std::size_t b,
                                     const ComparisonOptions& options) {
  RAYFIELD_CHECK(options.validate());
  if (a >= block.scans.size() || b >= block.scans.size())
    return fail(ErrorCode::usage, kWhat, block.block, "no such scan", "see `rayfield status`");
  const ScanResults &scan_a = block.scans[a], &scan_b = block.scans[b];
  if (a == b) return fail(ErrorCode::usage, kWhat, scan_a.scan.scan_id, "it is the same scan twice", "give two dates");
  DateComparison out;
  out.a = scan_a.scan, out.b = scan_b.scan;
  const auto values_a = by_panel(scan_a), values_b = by_panel(scan_b);
  for (const PanelProduct& panel : block.panels) {
    PanelChange change;
    change.panel_uid = panel.panel_uid, change.length_m = panel.length_m;
    change.row_number = panel.row_number, change.panel_number = panel.panel_number;
    const auto in_a = values_a.find(panel.panel_uid), in_b = values_b.find(panel.panel_uid);
    change.a = in_a == values_a.end() ? unseen(panel, out.a) : *in_a->second;
    change.b = in_b == values_b.end() ? unseen(panel, out.b) : *in_b->second;
    const bool seen = std::isfinite(change.a.leaf_area_m2) && std::isfinite(change.b.leaf_area_m2);
    seen ? take_change(change, options.error_correlation) : take_nothing(change);
    ++(seen ? out.compared : out.not_seen);
    if (change.verdict == ChangeVerdict::gain) ++out.gains;
    if (change.verdict == ChangeVerdict::loss) ++out.losses;
    out.panels.push_back(std::move(change));
  }
  if (out.compared == 0)
    return fail(ErrorCode::bad_input, kWhat, fmt::format("{} and {}", out.a.scan_id, out.b.scan_id),
                "no panel was seen on both dates", "see how much of the block each scan covers in its maps");
  out.leaf_total = total_of(out.panels, options.error_correlation);
  compare_panels(out);
  compare_half_metres(scan_a, scan_b, out);
  return out;
}

Result<RasterProduct> raster_change(const RasterProduct& a, const RasterProduct& b) {
  const Grid2<float>&from = a.grid, &to = b.grid;
  if (a.name != b.name || a.unit != b.unit || from.nx != to.nx || from.ny != to.ny || from.cell_m != to.cell_m ||
      from.origin != to.origin)
    return fail(ErrorCode::usage, "cannot subtract maps", a.name, "the maps do not lie upon each other",
                "run `rayfield process` so that all dates are mapped alike");
  RasterProduct out{a.name + "_change", a.unit, "Change of: " + a.description, from};
  for (std::size_t i = 0; i < out.grid.values.size(); ++i) out.grid.values[i] = to.values[i] - from.values[i];
  return out;
}

}  // namespace rayfield::density
