#include "libdensity/integration/row_shares.h"

#include <algorithm>
#include <limits>

#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<RowSpan> panel_spans(std::span<const Panel> panels) {
  std::vector<RowSpan> spans;
  for (std::size_t i = 0; i < panels.size(); ++i)
    spans.push_back({i == 0 ? -kInfinity : (panels[i - 1].end_m + panels[i].start_m) / 2,
                     i + 1 == panels.size() ? kInfinity : (panels[i].end_m + panels[i + 1].start_m) / 2});
  return spans;
}

std::vector<RowSpan> metre_spans(double row_length_m, double step_m) {
  const int count = std::max(1, round_int(row_length_m / step_m));
  std::vector<RowSpan> spans;
  for (int k = 0; k < count; ++k)
    spans.push_back({k == 0 ? -kInfinity : k * step_m, k == count - 1 ? kInfinity : (k + 1) * step_m});
  return spans;
}

double share_between(const RowDensity& row, int along, const RowSpan& span) {
  const double low = row.chainage_m[static_cast<std::size_t>(along)];
  return std::clamp((std::min(span.to_m, low + row.voxel_m) - std::max(span.from_m, low)) / row.voxel_m, 0.0, 1.0);
}

}  // namespace rayfield::density
