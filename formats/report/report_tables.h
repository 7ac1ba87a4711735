#pragma once

#include <string>

#include "rayfield/formats/report.h"

namespace rayfield::formats {

/// The weakest and the strongest panels of the date in focus, as HTML.
std::string ends_html(const BlockReport& report);

/// All gaps of the date in focus with their places, as HTML.
std::string gaps_html(const BlockReport& report);

}  // namespace rayfield::formats
