#include "formats/report/report_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "formats/io/text_escape.h"
#include "formats/report/report_summary.h"
#include "formats/report/report_words.h"

namespace rayfield::formats {
namespace {

constexpr std::size_t kEndsShown = 8;

std::string cell(const std::string& text) { return "<td>" + xml_escape(text) + "</td>"; }
std::string number_cell(const std::string& text) { return "<td class=\"number\">" + xml_escape(text) + "</td>"; }

struct SeenPanel {
  const PanelProduct* panel;
  const PanelValue* value;
  const PanelChange* change;  // since the date before; null if unknown
};

// Those with a value on the date in focus, the weakest per metre first.
std::vector<SeenPanel> seen_panels(const BlockReport& report) {
  std::map<std::string, const PanelValue*> values;
  for (const PanelValue& value : report.block.scans[report.focus].panel_values) values[value.panel_uid] = &value;
  std::map<std::string, const PanelChange*> changes;
  if (const DateComparison* c = since_before(report))
    for (const PanelChange& change : c->panels)
      if (change.verdict != ChangeVerdict::not_seen) changes[change.panel_uid] = &change;
  std::vector<SeenPanel> seen;
  for (const PanelProduct& panel : report.block.panels) {
    const auto value = values.find(panel.panel_uid);
    if (value == values.end() || !std::isfinite(value->second->leaf_area_per_m)) continue;
    const auto change = changes.find(panel.panel_uid);
    seen.push_back({&panel, value->second, change == changes.end() ? nullptr : change->second});
  }
  std::stable_sort(seen.begin(), seen.end(), [](const SeenPanel& a, const SeenPanel& b) {
    return a.value->leaf_area_per_m < b.value->leaf_area_per_m;
  });
  return seen;
}

std::string change_cell(const PanelChange* change) {
  if (change == nullptr) return cell("cannot be told");
  const auto [kind, words] = change->verdict == ChangeVerdict::gain   ? std::pair("gain", "clear gain")
                             : change->verdict == ChangeVerdict::loss ? std::pair("loss", "clear loss")
                                                                      : std::pair("none", "within its error");
  return fmt::format("<td>{} m² ± {} <span class=\"tag {}\">{}</span></td>", signed_number(change->leaf_change_m2, 1),
                     number((change->ci_high_m2 - change->ci_low_m2) / 2, 1), kind, words);
}

std::string panel_row(const BlockProducts& block, const SeenPanel& seen) {
  const PanelValue& v = *seen.value;
  return "<tr>" + cell(row_text(block, seen.panel->row_number)) +
         number_cell(std::to_string(seen.panel->panel_number)) +
         number_cell(
             fmt::format("{} ({} to {})", number(v.leaf_area_m2, 1), number(v.ci_low_m2, 1), number(v.ci_high_m2, 1))) +
         number_cell(number(v.leaf_area_per_m, 2)) + number_cell(number(100 * v.gap_fraction, 0) + " %") +
         change_cell(seen.change) + "</tr>\n";
}

std::string panel_table(const BlockProducts& block, const std::string& caption, const std::vector<SeenPanel>& panels) {
  std::string rows;
  for (const SeenPanel& panel : panels) rows += panel_row(block, panel);
  return "<div class=\"scroll\"><table><caption>" + xml_escape(caption) +
         "</caption><thead><tr><th scope=\"col\">Row</th><th scope=\"col\" class=\"number\">Panel</th><th "
         "scope=\"col\" "
         "class=\"number\">Leaf area, m² (95 %)</th><th scope=\"col\" class=\"number\">m² per metre</th><th "
         "scope=\"col\" class=\"number\">Open from the side</th><th scope=\"col\">Change since the date before (95 "
         "%)</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string gap_row(const BlockReport& report, const RowGap& gap, std::size_t dates) {
  return "<tr>" + cell(row_text(report.block, gap.row_number)) +
         number_cell(fmt::format("{} to {}", number(gap.start_m, 1), number(gap.end_m, 1))) +
         number_cell(number(gap.length_m(), 1)) +
         number_cell(gap.panel_number == 0 ? "–" : std::to_string(gap.panel_number)) +
         number_cell(fmt::format("{:.1f}", gap.position.x())) + number_cell(fmt::format("{:.1f}", gap.position.y())) +
         number_cell(std::to_string(dates)) + "</tr>\n";
}

}  // namespace

std::string ends_html(const BlockReport& report) {
  const std::string date = scan_label(report.block.scans[report.focus].scan);
  std::vector<SeenPanel> seen = seen_panels(report);
  if (seen.empty()) return "<p>No panel was observed on " + xml_escape(date) + ".</p>";
  const std::size_t count = std::min(kEndsShown, (seen.size() + 1) / 2);
  const std::vector<SeenPanel> weakest(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(count));
  std::reverse(seen.begin(), seen.end());
  const std::vector<SeenPanel> strongest(
      seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(std::min(count, seen.size() - count)));
  return panel_table(report.block, "Least leaf area per metre of row on " + date, weakest) +
         (strongest.empty() ? "" : panel_table(report.block, "Most leaf area per metre of row on " + date, strongest));
}

std::string gaps_html(const BlockReport& report) {
  const ReportScan& scan = report.scans[report.focus];
  const auto with_canopy =
      std::count_if(report.scans.begin(), report.scans.end(), [](const ReportScan& s) { return !s.dormant; });
  std::string html = fmt::format(
      "<p>A gap is a stretch of row of {} m or longer where, seen from the side, there is less than {} % of the plant "
      "area per metre that is usual in this block on this date. Posts do not count, and what was not observed is no "
      "gap. A gap that stays through the season is where a vine may be missing; the drives do not count vines one by "
      "one.</p>",
      number(report.min_gap_m, 1), number(100 * report.gap_share, 0));
  if (scan.gaps.empty())
    return html + "<p>No gap was found on " + xml_escape(scan_label(report.block.scans[report.focus].scan)) + ".</p>";
  html += fmt::format(
      "<div class=\"scroll\"><div class=\"tall\"><table><caption>All gaps on {}; eastings and northings of their "
      "middles in {}</caption>"
      "<thead><tr><th scope=\"col\">Row</th><th scope=\"col\" class=\"number\">From the row's start, m</th><th "
      "scope=\"col\" class=\"number\">Length, m</th><th scope=\"col\" class=\"number\">Panel</th><th scope=\"col\" "
      "class=\"number\">Easting</th><th scope=\"col\" class=\"number\">Northing</th><th scope=\"col\" "
      "class=\"number\">A gap on so many of {} dates with leaves</th></tr></thead><tbody>\n",
      xml_escape(scan_label(report.block.scans[report.focus].scan)), xml_escape(report.block.crs), with_canopy);
  for (std::size_t i = 0; i < scan.gaps.size(); ++i) html += gap_row(report, scan.gaps[i], scan.seen_as_gap[i]);
  return html + "</tbody></table></div></div>\n";
}

}  // namespace rayfield::formats
