#include "formats/report/report_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "formats/io/text_escape.h"
#include "formats/report/report_words.h"

namespace rayfield::formats {
namespace {

constexpr std::size_t kWeakShown = 5, kLossesShown = 4, kGapsShown = 3;

std::string tile(const std::string& name, const std::string& value, const std::string& unit, const std::string& more) {
  return fmt::format(
      "<div class=\"tile\"><p class=\"name\">{}</p><p class=\"value\">{} <small>{}</small></p><p class=\"more\">{}</p>"
      "</div>\n",
      xml_escape(name), words_html(value), words_html(unit), words_html(more));
}

const SeasonValue* block_value(const BlockReport& report) {
  for (const SeasonValue& v : report.season)
    if (v.row_number == 0 && v.scan_id == report.block.scans[report.focus].scan.scan_id) return &v;
  return nullptr;
}

std::string leaf_tile(const BlockReport& report) {
  const SeasonValue* v = block_value(report);
  const std::string name = "Leaf area on " + scan_label(report.block.scans[report.focus].scan);
  if (v == nullptr || v->panels_seen == 0) return tile(name, "not observed", "", "");
  const std::string seen = v->panels_seen == v->panels
                               ? fmt::format("all {} panels observed", v->panels)
                               : fmt::format("{} of {} panels observed", v->panels_seen, v->panels);
  return tile(name, number(v->leaf_area_per_m, 2), "m² per metre of row",
              fmt::format("95 %: {} to {}. Together {} m²; {}.", number(v->ci_low_per_m, 2),
                          number(v->ci_high_per_m, 2), number(v->leaf_area_m2, 0), seen));
}

std::string change_tile(const BlockReport& report) {
  const DateComparison* c = since_before(report);
  if (c == nullptr) return tile("Change", "–", "", "There is no earlier date to compare with.");
  const TotalChange& t = c->leaf_total;
  const bool clear = t.verdict == ChangeVerdict::gain || t.verdict == ChangeVerdict::loss;
  const std::string value = t.area_a_m2 > 0.05 * t.area_b_m2 ? signed_number(100 * t.change_m2 / t.area_a_m2, 0) + " %"
                                                             : signed_number(t.change_m2, 0) + " m²";
  return tile("Change since " + scan_label(c->a), value, clear ? "a clear change" : "within its error",
              fmt::format("{} m² (95 %: {} to {}). Panels: {} clear gain, {} clear loss, {} within their errors.",
                          signed_number(t.change_m2, 0), signed_number(t.ci_low_m2, 0), signed_number(t.ci_high_m2, 0),
                          c->gains, c->losses, c->compared - c->gains - c->losses));
}

// Mean leaf area per metre of the panels of class 0, relative to that of all.
std::string weak_tile(const BlockReport& report) {
  const SeasonValue* v = block_value(report);
  double leaf = 0, length = 0;
  std::size_t count = 0;
  const std::vector<PanelValue>& values = report.block.scans[report.focus].panel_values;
  for (std::size_t i = 0; i < report.block.panels.size(); ++i) {
    if (report.scans[report.focus].classes[i] != 0) continue;
    const auto value = std::find_if(values.begin(), values.end(), [&](const PanelValue& p) {
      return p.panel_uid == report.block.panels[i].panel_uid;
    });
    if (value == values.end()) continue;
    leaf += value->leaf_area_m2, length += report.block.panels[i].length_m, ++count;
  }
  if (v == nullptr || count == 0 || !(v->leaf_area_per_m > 0)) return tile("Weakest fifth of the panels", "–", "", "");
  const double below = 1 - leaf / length / v->leaf_area_per_m;
  return tile("Weakest fifth of the panels", number(100 * below, 0) + " %", "below the block's mean",
              fmt::format("{} panels with {} m² per metre of row; the block has {}.", count, number(leaf / length, 2),
                          number(v->leaf_area_per_m, 2)));
}

std::string gaps_tile(const BlockReport& report) {
  double gap = 0, length = 0;
  for (const RowGap& g : report.scans[report.focus].gaps) gap += g.length_m();
  for (const RowProduct& row : report.block.rows) length += row.length_m;
  const std::string name = fmt::format("Gaps of {} m or longer", number(report.min_gap_m, 1));
  return tile(name, std::to_string(report.scans[report.focus].gaps.size()), "",
              fmt::format("Together {} m, {} % of {} m of row.", number(gap, 1), number(100 * gap / length, 1),
                          number(length, 0)));
}

std::string item(const std::string& where, const std::string& what) {
  return "<li><b>" + xml_escape(where) + "</b> <span>" + words_html(what) + "</span></li>\n";
}

std::string weak_items(const BlockReport& report) {
  const SeasonValue* v = block_value(report);
  std::string html;
  for (std::size_t i = 0; i < std::min(kWeakShown, report.weak.size()) && v != nullptr; ++i) {
    const WeakStretch& w = report.weak[i];
    html +=
        item(fmt::format("{}, {}", row_text(report.block, w.row_number), panels_text(w)),
             fmt::format("Weak: {} m² of leaf area per metre of row, {} % below the block's mean. {} to {} m from the "
                         "row's start.",
                         number(w.leaf_area_per_m, 2), number(100 * (1 - w.leaf_area_per_m / v->leaf_area_per_m), 0),
                         number(w.start_m, 0), number(w.end_m, 0)));
  }
  return html;
}

std::string loss_items(const BlockReport& report) {
  const DateComparison* c = since_before(report);
  if (c == nullptr || report.scans[report.focus].dormant) return {};
  std::vector<const PanelChange*> losses;
  for (const PanelChange& p : c->panels)
    if (p.verdict == ChangeVerdict::loss) losses.push_back(&p);
  std::stable_sort(losses.begin(), losses.end(), [](const PanelChange* a, const PanelChange* b) {
    return a->leaf_change_per_m < b->leaf_change_per_m;
  });
  std::string html;
  for (std::size_t i = 0; i < std::min(kLossesShown, losses.size()); ++i) {
    const PanelChange& p = *losses[i];
    html += item(
        fmt::format("{}, panel {}", row_text(report.block, p.row_number), p.panel_number),
        fmt::format("Clear loss since {}: {} m² (95 %: {} to {}).", scan_label(c->a),
                    signed_number(p.leaf_change_m2, 1), signed_number(p.ci_low_m2, 1), signed_number(p.ci_high_m2, 1)));
  }
  return html;
}

std::string gap_items(const BlockReport& report) {
  const ReportScan& scan = report.scans[report.focus];
  std::vector<std::size_t> order(scan.gaps.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return scan.gaps[a].length_m() > scan.gaps[b].length_m(); });
  const auto with_leaves =
      std::count_if(report.scans.begin(), report.scans.end(), [](const ReportScan& s) { return !s.dormant; });
  std::string html;
  for (std::size_t i = 0; i < std::min(kGapsShown, order.size()); ++i) {
    const RowGap& gap = scan.gaps[order[i]];
    const std::size_t dates = scan.seen_as_gap[order[i]];
    const std::string often =
        dates > 1 ? fmt::format(" It is one on {} of {} dates with leaves: a vine may be missing or dead.", dates,
                                with_leaves)
                  : std::string(" Only on this date.");
    html += item(fmt::format("{}, {} to {} m", row_text(report.block, gap.row_number), number(gap.start_m, 1),
                             number(gap.end_m, 1)),
                 fmt::format("Gap of {} m with hardly any canopy.", number(gap.length_m(), 1)) + often);
  }
  return html;
}

std::string unseen_item(const BlockReport& report) {
  const std::vector<int>& classes = report.scans[report.focus].classes;
  const auto unseen = std::count(classes.begin(), classes.end(), -1);
  if (unseen == 0) return {};
  return item("Not observed", fmt::format("{} of {} panels were not observed well enough to have a value on this date. "
                                          "They are hatched on the map and say nothing, neither good nor bad.",
                                          unseen, classes.size()));
}

}  // namespace

const DateComparison* since_before(const BlockReport& report) {
  if (report.focus == 0) return nullptr;
  for (const DateComparison& c : report.comparisons)
    if (c.a.scan_id == report.block.scans[report.focus - 1].scan.scan_id &&
        c.b.scan_id == report.block.scans[report.focus].scan.scan_id)
      return &c;
  return nullptr;
}

std::string tiles_html(const BlockReport& report) {
  return leaf_tile(report) + change_tile(report) + weak_tile(report) + gaps_tile(report);
}

std::string look_html(const BlockReport& report) {
  const std::string when = "<p class=\"caption\">As of " +
                           xml_escape(scan_label(report.block.scans[report.focus].scan)) +
                           ". Places are counted from the row's start, where the row's number stands on the map.</p>";
  if (report.scans[report.focus].dormant)
    return when + "<p>The vines bear no leaves on any date of this block: nothing can be said of weak places yet.</p>";
  return when + "<ol class=\"look\">" + weak_items(report) + loss_items(report) + gap_items(report) +
         unseen_item(report) + "</ol>";
}

}  // namespace rayfield::formats
