#pragma once

#include <string>

#include "rayfield/formats/report.h"

namespace rayfield::formats {

/// Where the figures come from and how sure they are, as HTML: the block, every scan, and how to read the numbers.
std::string quality_html(const BlockReport& report);

}  // namespace rayfield::formats
