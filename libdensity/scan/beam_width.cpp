#include "libdensity/scan/beam_width.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace rayfield::density {
namespace {

constexpr double kTypicalRangeM = 2;  // from a lane to the row beside it
constexpr double kErrorPerM = 8;      // relative error by the diameter there

double diameter_of(const tile::ScanEntry& scan) { return scan.beam ? scan.beam->diameter_at(kTypicalRangeM) : 0; }

}  // namespace

IntegrationOptions integration_with_beam(const IntegrationOptions& integration, const tile::ScanEntry& scan) {
  IntegrationOptions options = integration;
  options.shared_error = std::min(1.0, std::hypot(options.shared_error, kErrorPerM * diameter_of(scan)));
  return options;
}

std::string beam_note(const tile::ScanEntry& scan) {
  const double diameter = diameter_of(scan);
  if (diameter <= 0) return {};
  return fmt::format(
      "the beam of {}'s lidar is {:.0f} mm wide at {:.0f} m, which is not taken out of the areas yet: they are off by "
      "about "
      "{:.0f} %, and their intervals say so",
      scan.scan_id, 1000 * diameter, kTypicalRangeM, 100 * std::min(1.0, kErrorPerM * diameter));
}

}  // namespace rayfield::density
