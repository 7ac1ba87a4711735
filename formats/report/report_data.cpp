#include "formats/report/report_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/io/text_escape.h"
#include "formats/picture/color.h"
#include "formats/report/packed_grid.h"
#include "formats/report/report_scales.h"
#include "formats/report/report_words.h"

namespace rayfield::formats {
namespace {

using nlohmann::ordered_json;

// To a hundredth unless said otherwise: finer than any value is sure.
ordered_json rounded(double value, double steps = 100) {
  if (!std::isfinite(value)) return nullptr;
  const double nearest = std::round(value * steps) / steps;
  return nearest == std::round(nearest) ? ordered_json(static_cast<std::int64_t>(nearest)) : ordered_json(nearest);
}

ordered_json stops_json(std::span<const Rgba> stops) {
  ordered_json json = ordered_json::array();
  for (const Rgba& stop : stops) json.push_back(hex_text(stop));
  return json;
}

// Low red, middle green, high blue, as the paper's figures have it; pale where there is nothing.
ordered_json paper_ramp() {
  return {"#faf6f0", "#c81e1e", "#a0601e", "#5f9a28", "#28a03c", "#28868c", "#2864b4", "#1e3ca0"};
}

struct Layout {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // local coordinates are small
  std::map<int, std::size_t> row_place;
};

ordered_json points_json(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& origin) {
  ordered_json json = ordered_json::array();
  for (const Eigen::Vector2d& p : points)
    json.push_back(rounded(p.x() - origin.x())), json.push_back(rounded(p.y() - origin.y()));
  return json;
}

ordered_json rows_json(const BlockProducts& block, const Layout& layout) {
  ordered_json json = ordered_json::array();
  for (const RowProduct& row : block.rows) {
    ordered_json posts = ordered_json::array();
    for (const PostProduct& post : block.posts)
      if (post.row_number == row.row_number) posts.push_back(rounded(post.chainage_m));
    json.push_back({{"number", row.row_number},
                    {"name", clean_text(row.row_name)},
                    {"length", rounded(row.length_m)},
                    {"line", points_json({row.centreline.front(), row.centreline.back()}, layout.origin)},
                    {"posts", posts}});
  }
  return json;
}

// A panel's ring runs along one side and back along the other. Start, middle and end of both are enough to draw it: on
// a curve of 50 m radius half a panel of 6.5 m is off by 3 cm.
std::vector<Eigen::Vector2d> slim_ring(std::vector<Eigen::Vector2d> ring) {
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  const std::size_t count = ring.size(), half = count / 2;
  if (count % 2 != 0 || half <= 3) return ring;
  std::vector<Eigen::Vector2d> slim;
  for (const std::size_t i : {std::size_t{0}, half / 2, half - 1}) slim.push_back(ring[i]);
  for (const std::size_t i : {half - 1, half / 2, std::size_t{0}}) slim.push_back(ring[count - 1 - i]);
  return slim;
}

ordered_json panels_json(const BlockProducts& block, const Layout& layout) {
  ordered_json json = ordered_json::array();
  for (const PanelProduct& p : block.panels)
    json.push_back({layout.row_place.at(p.row_number), p.panel_number, rounded(p.chainage_start_m),
                    rounded(p.chainage_end_m), rounded(p.length_m), points_json(slim_ring(p.outline), layout.origin)});
  return json;
}

// One list per quantity, in the order of the block's panels; null where the panel was not observed.
ordered_json values_json(const BlockProducts& block, const ScanResults& scan) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::map<std::string, const PanelValue*> by_panel;
  for (const PanelValue& value : scan.panel_values) by_panel[value.panel_uid] = &value;
  const PanelValue unseen{.leaf_area_m2 = kNone,
                          .ci_low_m2 = kNone,
                          .ci_high_m2 = kNone,
                          .canopy_height_m = kNone,
                          .canopy_width_m = kNone,
                          .gap_fraction = kNone};
  ordered_json json;
  const auto list = [&](const char* name, auto value_of, double steps = 100) {
    ordered_json& values = json[name] = ordered_json::array();
    for (const PanelProduct& panel : block.panels) {
      const auto found = by_panel.find(panel.panel_uid);
      values.push_back(rounded(value_of(found == by_panel.end() ? unseen : *found->second), steps));
    }
  };
  list("leaf", [](const PanelValue& v) { return v.leaf_area_m2; });
  list("low", [](const PanelValue& v) { return v.ci_low_m2; });
  list("high", [](const PanelValue& v) { return v.ci_high_m2; });
  list("height", [](const PanelValue& v) { return v.canopy_height_m; });
  list("width", [](const PanelValue& v) { return v.canopy_width_m; });
  list("open", [](const PanelValue& v) { return v.gap_fraction; });
  list("seen", [](const PanelValue& v) { return v.observed_fraction; });
  list("porosity", [](const PanelValue& v) { return v.descriptors.porosity; });
  list(
      "layers", [](const PanelValue& v) { return v.descriptors.leaf_layer_number; }, 10);
  list("exposed", [](const PanelValue& v) { return v.descriptors.exposed_leaf_share; });
  list("fruit", [](const PanelValue& v) { return v.descriptors.fruit_zone_area_per_m; });
  return json;
}

Result<ordered_json> grid_json(const Grid2<float>& grid, const Eigen::Vector2d& origin, double high) {
  RAYFIELD_ASSIGN(std::string packed, packed_grid(grid, high));
  return ordered_json{{"x", rounded(grid.origin.x() - origin.x(), 1e4)},
                      {"y", rounded(grid.origin.y() - origin.y(), 1e4)},
                      {"cell", rounded(grid.cell_m, 1e6)},
                      {"nx", grid.nx},
                      {"ny", grid.ny},
                      {"data", std::move(packed)}};
}

// The side view of each row; null where the scan has none.
Result<ordered_json> sides_json(const BlockProducts& block, const ScanResults& scan, int factor, double high) {
  ordered_json json = ordered_json::array();
  for (const RowProduct& row : block.rows) {
    const auto section = std::find_if(scan.sections.begin(), scan.sections.end(), [&](const SectionProduct& s) {
      return s.row_number == row.row_number && s.name.starts_with("side_view");
    });
    if (section == scan.sections.end()) {
      json.push_back(nullptr);
      continue;
    }
    RAYFIELD_ASSIGN(ordered_json grid, grid_json(coarser(section->grid, factor), Eigen::Vector2d::Zero(), high));
    json.push_back(std::move(grid));
  }
  return json;
}

// Whole factor by which all side views are made coarser, so that they keep within the bound.
int side_view_factor(const BlockProducts& block, const ReportOptions& options) {
  for (int factor = 1;; ++factor) {
    std::size_t cells = 0;
    for (const ScanResults& scan : block.scans)
      for (const SectionProduct& s : scan.sections)
        if (s.name.starts_with("side_view"))
          cells += static_cast<std::size_t>((s.grid.nx + factor - 1) / factor) *
                   static_cast<std::size_t>((s.grid.ny + factor - 1) / factor);
    if (cells <= options.max_side_view_cells || factor == 1000) return factor;
  }
}

ordered_json season_json(const SeasonValue& v) {
  if (v.panels_seen == 0) return nullptr;
  return {rounded(v.leaf_area_per_m, 1e3), rounded(v.ci_low_per_m, 1e3), rounded(v.ci_high_per_m, 1e3)};
}

void add_season(const BlockReport& report, const Layout& layout, const std::string& scan_id, ordered_json& json) {
  json["block"] = nullptr;
  json["rows"] = ordered_json(std::vector<std::nullptr_t>(report.block.rows.size()));
  for (const SeasonValue& v : report.season) {
    if (v.scan_id != scan_id) continue;
    const auto row = layout.row_place.find(v.row_number);
    if (v.row_number == 0) json["block"] = season_json(v);
    if (row != layout.row_place.end()) json["rows"][row->second] = season_json(v);
  }
}

// Both ends of a gap on the row's straight line between its vertices.
ordered_json gaps_json(const BlockReport& report, const ReportScan& scan, const Layout& layout) {
  ordered_json json = ordered_json::array();
  for (const RowGap& gap : scan.gaps) {
    const RowProduct& row = report.block.rows[layout.row_place.at(gap.row_number)];
    const Eigen::Vector2d along = (row.centreline.back() - row.centreline.front()).normalized() * gap.length_m() / 2;
    const ordered_json ends = points_json({gap.position - along, gap.position + along}, layout.origin);
    json.push_back({layout.row_place.at(gap.row_number), ends[0], ends[1], ends[2], ends[3]});
  }
  return json;
}

std::string classes_text(const std::vector<int>& classes) {
  std::string text;
  for (const int c : classes) text += c < 0 ? '-' : static_cast<char>('0' + c);
  return text;
}

Result<ordered_json> scan_json(const BlockReport& report, std::size_t i, const Layout& layout,
                               const ReportScales& scales, int side_factor) {
  const ScanResults& results = report.block.scans[i];
  const ReportScan& scan = report.scans[i];
  const std::string& date = results.scan.scan_date;
  ordered_json json = {
      {"date", date},
      {"label", clean_text(scan_label(results.scan))},
      {"tick", date_text(date).substr(0, date_text(date).size() - 5) + " ’" + date.substr(2, 2)},
      {"dormant", scan.dormant},
      {"fruit_zone", {rounded(results.scan.fruit_zone_low_m), rounded(results.scan.fruit_zone_high_m)}},
      {"classes", classes_text(scan.classes)},
      {"gaps", gaps_json(report, scan, layout)},
      {"values", values_json(report.block, results)}};
  add_season(report, layout, results.scan.scan_id, json);
  RAYFIELD_ASSIGN(json["map"], grid_json(scan.plan_density, layout.origin, scales.map));
  RAYFIELD_ASSIGN(json["sides"], sides_json(report.block, results, side_factor, scales.side));
  return json;
}

char verdict_letter(ChangeVerdict verdict) {
  switch (verdict) {
    case ChangeVerdict::gain:
      return 'g';
    case ChangeVerdict::loss:
      return 'l';
    case ChangeVerdict::none:
      return 'n';
    case ChangeVerdict::not_seen:
      break;
  }
  return '-';
}

ordered_json pairs_json(const BlockReport& report) {
  std::map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < report.block.scans.size(); ++i) place[report.block.scans[i].scan.scan_id] = i;
  ordered_json json = ordered_json::array();
  for (const DateComparison& c : report.comparisons) {
    std::string verdicts;
    ordered_json half = ordered_json::array();
    for (const PanelChange& p : c.panels) {
      verdicts += verdict_letter(p.verdict);
      half.push_back(rounded((p.ci_high_m2 - p.ci_low_m2) / 2));
    }
    json.push_back({{"a", place.at(c.a.scan_id)},
                    {"b", place.at(c.b.scan_id)},
                    {"verdicts", verdicts},
                    {"half", half},
                    {"unseen", c.not_seen},
                    {"change", rounded(c.leaf_total.change_m2)},
                    {"low", rounded(c.leaf_total.ci_low_m2)},
                    {"high", rounded(c.leaf_total.ci_high_m2)},
                    {"rrmse", rounded(c.leaf_per_m.rrmse, 1e4)},
                    {"slope", rounded(c.leaf_per_m.slope, 1e4)},
                    {"intercept", rounded(c.leaf_per_m.intercept, 1e4)},
                    {"r2", rounded(c.leaf_per_m.r_squared, 1e3)}});
  }
  return json;
}

// What is shown before anything is chosen: the first panel to look at.
std::size_t first_panel(const BlockReport& report) {
  for (std::size_t i = 0; i < report.block.panels.size() && !report.weak.empty(); ++i)
    if (report.block.panels[i].row_number == report.weak.front().row_number &&
        report.block.panels[i].panel_number == report.weak.front().first_panel)
      return i;
  return 0;
}

}  // namespace

Result<std::string> report_data(const BlockReport& report, const ReportOptions& options) {
  const BlockProducts& block = report.block;
  Layout layout;
  layout.origin = block.rows.front().centreline.front();
  for (std::size_t i = 0; i < block.rows.size(); ++i) layout.row_place[block.rows[i].row_number] = i;
  const ReportScales scales = report_scales(report);
  ordered_json json = {
      {"focus", report.focus},
      {"first_panel", first_panel(report)},
      {"levels", kPackedLevels},
      {"classes", kReportClasses},
      {"scale", {{"leaf", scales.leaf}, {"map", scales.map}, {"side", scales.side}, {"change", scales.change}}},
      {"ramps",
       {{"canopy", stops_json(ramp_stops(Ramp::canopy))},
        {"paper", paper_ramp()},
        {"change", stops_json(ramp_stops(Ramp::change))}}},
      {"rows", rows_json(block, layout)},
      {"panels", panels_json(block, layout)},
      {"scans", ordered_json::array()},
      {"pairs", pairs_json(report)}};
  const int factor = side_view_factor(block, options);
  for (std::size_t i = 0; i < block.scans.size(); ++i) {
    RAYFIELD_ASSIGN(ordered_json scan, scan_json(report, i, layout, scales, factor));
    json["scans"].push_back(std::move(scan));
  }
  return json.dump();
}

}  // namespace rayfield::formats
