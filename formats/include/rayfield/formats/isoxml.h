#pragma once

#include <string>

#include "rayfield/core/result.h"
#include "rayfield/core/zone_products.h"

/// The task that carries rates to a machine (docs/farm-systems.md, "Prescription map").
namespace rayfield::formats {

/// An ISO 11783-10 task as ZIP archive with TASKDATA/TASKDATA.XML (version 3.3): farm, field with its boundary, product
/// and one planned task, in which every polygon is a treatment zone with its setpoint. Where no zone lies, and where
/// the machine does not know where it is, the rate is 0. Names are cut to 32 characters. Errors: usage (CRS, more than
/// 254 polygons), internal, resources, bad_input (no such folder).
Result<void> write_isoxml(const ZoneMap& map, const Prescription& rates, const std::string& path);

}  // namespace rayfield::formats
