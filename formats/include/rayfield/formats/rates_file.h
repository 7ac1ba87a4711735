#pragma once

#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/core/zone_products.h"

/// Rates for the zones of a block, as given by the user (docs/farm-systems.md, "Prescription map").
namespace rayfield::formats {

/// Units that rates may have: "l/ha", "ml/m2", "m3/ha", "gal/ac", "kg/ha", "g/m2", "t/ha", "lb/ac", "1/ha", "1/m2".
std::vector<std::string> rate_units();

/// Reads rates from a CSV file with the columns `zone` and `rate` (commas, semicolons or tabs; decimal points), one
/// line for each of the zones. `unit`: one of rate_units(), in any case. Errors: usage (unknown unit, no product);
/// bad_input (no such file, columns or numbers that are not there, zones missing, unknown or given twice, rates that
/// are negative or too large for the unit), resources (no permission).
Result<Prescription> read_rates(const std::string& path, const std::string& unit, const std::string& product,
                                const std::vector<ManagementZone>& zones);

}  // namespace rayfield::formats
