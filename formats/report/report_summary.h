#pragma once

#include <string>

#include "rayfield/formats/report.h"

namespace rayfield::formats {

/// What a grower asks first, as HTML: figures of the date in focus, and where to go and look.
std::string tiles_html(const BlockReport& report);
std::string look_html(const BlockReport& report);

/// The comparison of the date in focus with the one before it; null where it is the first, or no panel was observed on
/// both.
const DateComparison* since_before(const BlockReport& report);

}  // namespace rayfield::formats
