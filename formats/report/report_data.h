#pragma once

#include <string>

#include "rayfield/core/result.h"
#include "rayfield/formats/report.h"

namespace rayfield::formats {

/// What the page's script draws from, as JSON: see formats/report/page/base.js for its use. Lengths in m, areas in m²;
/// null = not observed. Errors: resources.
Result<std::string> report_data(const BlockReport& report, const ReportOptions& options);

}  // namespace rayfield::formats
