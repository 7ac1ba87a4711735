#pragma once

#include <span>
#include <string_view>

namespace rayfield::formats {

/// A unit of application rates as ISO 11783-11 counts it: a whole number of steps of a data dictionary entry.
struct RateUnit {
  std::string_view name;
  const char* ddi;  ///< 0001 volume, 0006 mass, 000B count per area: setpoints
  double steps;     ///< per unit; of 0.01 mm³/m², 1 mg/m² and 0.001 /m²
  int decimals;     ///< that people are shown
};

std::span<const RateUnit> known_rate_units();
/// In any case; null where there is none.
const RateUnit* find_rate_unit(std::string_view name);

}  // namespace rayfield::formats
