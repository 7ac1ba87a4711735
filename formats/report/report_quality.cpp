#include "formats/report/report_quality.h"

#include <fmt/core.h>

#include <cmath>

#include "formats/io/text_escape.h"
#include "formats/report/report_words.h"

namespace rayfield::formats {
namespace {

std::string fact(const std::string& name, const std::string& html) {
  return html.empty() ? "" : "<dt>" + xml_escape(name) + "</dt><dd>" + html + "</dd>\n";
}

std::string grouped(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, " ");
  return digits;
}

std::string inputs_html(const ReportScan& scan) {
  std::string html;
  for (const ReportInput& input : scan.inputs)
    html += fmt::format("{}{}, {} bytes<br><code>SHA-256 {}</code>", html.empty() ? "" : "<br>", xml_escape(input.name),
                        grouped(input.size), xml_escape(input.sha256));
  return html;
}

std::string coverage_text(const ScanResults& results, std::size_t panels) {
  std::size_t seen = 0;
  double observed = 0;
  for (const PanelValue& value : results.panel_values)
    if (std::isfinite(value.leaf_area_m2)) ++seen, observed += value.observed_fraction;
  if (seen == 0) return fmt::format("none of {} panels observed", panels);
  return fmt::format("{} of {} panels observed; in them {} % of the canopy's space was crossed by at least two rays",
                     seen, panels, number(100 * observed / static_cast<double>(seen), 0));
}

// What was subtracted from the leaf areas, or is still in them.
std::string leaf_text(const BlockReport& report, const ReportScan& scan, const ScanProduct& product) {
  if (!product.leaf_note.empty()) return product.leaf_note;
  if (scan.dormant) return "dormant: the vines bear no leaves";
  for (const ScanResults& other : report.block.scans)
    if (other.scan.scan_id == product.wood_scan_id)
      return "leaves alone: the wood that " + scan_label(other.scan) + " shows is subtracted";
  return product.wood_scan_id.empty() ? ""
                                      : "leaves alone: the wood of scan " + product.wood_scan_id + " is subtracted";
}

std::string scan_html(const BlockReport& report, std::size_t i) {
  const ScanResults& results = report.block.scans[i];
  const ReportScan& scan = report.scans[i];
  std::string html = "<div class=\"scan\"><h3>" + xml_escape(scan_label(results.scan)) + "</h3><dl class=\"facts\">\n";
  html += fact("Position", xml_escape(scan.alignment));
  html += fact("Coverage", xml_escape(coverage_text(results, report.block.panels.size())));
  html += fact("Leaf area", xml_escape(leaf_text(report, scan, results.scan)));
  html += fact("Lidar beam", xml_escape(scan.beam.empty() ? "not known: treated as a line, which makes areas of wide "
                                                            "beams too large"
                                                          : scan.beam));
  html += fact("Driven", xml_escape(fmt::format("{} to {}", results.scan.start_utc, results.scan.end_utc)));
  html += fact("Rays", grouped(results.scan.ray_count));
  html += fact("Made of", inputs_html(scan));
  for (const std::string& warning : scan.warnings)
    html += fact("Warning", "<span class=\"warning\">" + xml_escape(warning) + "</span>");
  return html + "</dl></div>\n";
}

constexpr const char* kReading = R"(<h3>How to read the numbers</h3>
<p>Leaf area is the one-sided area of the leaves, measured by how freely laser rays pass through the canopy. A panel is
the stretch of row between two posts. Figures are per panel (m²) or per metre of row (m²), so that long and short panels
can be compared.</p>
<p>The interval in brackets holds the true value 95 times in 100. It counts what single voxels are unsure of and what
leaf angles do to all of them. A change is called clear only where the interval of the change itself leaves out zero; of
panels that did not change, one in twenty reads as a clear gain or loss by chance. What the intervals do not hold: drives
that were not laid on the first to a few centimetres, and wood that grew or was cut.</p>
<p>“Open from the side” is the share of the panel's side view that lets light through, over the heights where nearly
all of its area is. Porosity is the same inside the canopy's outline: the share of lines across the row that meet neither
leaf nor wood. Leaf layers are how many leaves such a line meets in the mean, exposed leaves those that are the first or
the last of their line. The fruit zone is the leaf area between two heights over the ground at the row.</p>
<p>“Not observed” means that too few rays saw the place. It never means zero.</p>
<p>Colours mean the same on all dates: each scale reaches to the value that 98 % of this block stay below, and larger
values take the last colour.</p>
)";

}  // namespace

std::string quality_html(const BlockReport& report) {
  const BlockProducts& block = report.block;
  std::string html = "<dl class=\"facts\">\n";
  html += fact("Block", xml_escape(block.block));
  html += fact("Farm", xml_escape(block.farm));
  html += fact("Variety", xml_escape(block.variety));
  html += fact("Coordinates", xml_escape(block.crs));
  html += fact("State of the store", fmt::format("snapshot {}", block.snapshot));
  html += fact("Made with", xml_escape(report.software));
  html += "</dl>\n<h3>Drives</h3>\n";
  for (std::size_t i = 0; i < block.scans.size(); ++i) html += scan_html(report, i);
  return html + kReading;
}

}  // namespace rayfield::formats
