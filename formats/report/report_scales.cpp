#include "formats/report/report_scales.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace rayfield::formats {
namespace {

constexpr double kQuantile = 0.98;
constexpr std::size_t kMaxSample = 1'000'000;  // of a quantile; every n-th value of more

// Values to take a quantile of: every n-th of what `count` values in all give.
class Sample {
 public:
  explicit Sample(std::size_t count) : every_(count / kMaxSample + 1) {}
  void add(std::span<const float> values) {
    for (; next_ < values.size(); next_ += every_) values_.push_back(values[next_]);
    next_ -= values.size();
  }
  std::vector<float> take() { return std::move(values_); }

 private:
  std::size_t every_, next_ = 0;
  std::vector<float> values_;
};

bool is_side_view(const SectionProduct& section) { return section.name.starts_with("side_view"); }

double map_scale(const BlockReport& report) {
  std::size_t count = 0;
  for (const ReportScan& scan : report.scans) count += scan.plan_density.values.size();
  Sample sample(count);
  for (const ReportScan& scan : report.scans) sample.add(scan.plan_density.values);
  return scale_end(sample.take());
}

double side_scale(const BlockReport& report) {
  std::size_t count = 0;
  for (const ScanResults& scan : report.block.scans)
    for (const SectionProduct& section : scan.sections)
      if (is_side_view(section)) count += section.grid.values.size();
  Sample sample(count);
  for (const ScanResults& scan : report.block.scans)
    for (const SectionProduct& section : scan.sections)
      if (is_side_view(section)) sample.add(section.grid.values);
  return scale_end(sample.take());
}

double change_scale(const BlockReport& report) {
  std::vector<float> changes;
  for (const DateComparison& c : report.comparisons)
    for (std::size_t i = 0; i + 1 < report.block.scans.size(); ++i) {
      if (c.a.scan_id != report.block.scans[i].scan.scan_id) continue;
      if (c.b.scan_id != report.block.scans[i + 1].scan.scan_id) continue;
      for (const PanelChange& panel : c.panels)
        changes.push_back(static_cast<float>(std::abs(panel.leaf_change_per_m)));
    }
  return scale_end(std::move(changes));
}

}  // namespace

double scale_end(std::vector<float> values) {
  std::erase_if(values, [](float v) { return !(v > 0) || !std::isfinite(v); });
  if (values.empty()) return 1;
  const auto rank = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const double wanted = static_cast<double>(values[static_cast<std::size_t>(rank)]);
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double factor : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (factor * power >= wanted * (1 - 1e-6)) return factor * power;
  return 10 * power;
}

ReportScales report_scales(const BlockReport& report) {
  ReportScales scales;
  std::vector<float> leaf;
  for (const ScanResults& scan : report.block.scans)
    for (const PanelValue& value : scan.panel_values) leaf.push_back(static_cast<float>(value.leaf_area_per_m));
  scales.leaf = scale_end(std::move(leaf));
  scales.map = map_scale(report), scales.side = side_scale(report), scales.change = change_scale(report);
  return scales;
}

}  // namespace rayfield::formats
