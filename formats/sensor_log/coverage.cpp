#include "formats/sensor_log/coverage.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayfield::formats {

std::vector<std::string> coverage_problems(std::span<const SensorSpan> sensors) {
  std::vector<std::string> lines;
  if (sensors.empty()) return lines;
  const SensorSpan& reference = sensors.front();
  const auto apart = [&](const SensorSpan& s) { return s.first_s > reference.last_s || s.last_s < reference.first_s; };
  double first_s = reference.first_s, last_s = reference.last_s;
  for (const SensorSpan& each : sensors) {
    if (apart(each)) continue;
    first_s = std::min(first_s, each.first_s);
    last_s = std::max(last_s, each.last_s);
  }
  for (const SensorSpan& each : sensors) {
    if (apart(each)) {
      const double offset_s = each.first_s - reference.first_s;
      lines.push_back(fmt::format("{}: its stamps lie {:.1f} s {} those of {}: the clocks do not agree", each.name,
                                  offset_s < 0 ? -offset_s : offset_s, offset_s < 0 ? "before" : "after",
                                  reference.name));
      continue;
    }
    if (each.first_s - first_s > each.tolerance_s)
      lines.push_back(fmt::format("{}: begins {:.1f} s after the others", each.name, each.first_s - first_s));
    if (last_s - each.last_s > each.tolerance_s)
      lines.push_back(fmt::format("{}: ends {:.1f} s before the others", each.name, last_s - each.last_s));
  }
  return lines;
}

}  // namespace rayfield::formats
