#pragma once

#include <string>

#include "rayfield/core/products.h"
#include "rayfield/formats/report.h"

namespace rayfield::formats {

/// "11 Feb 2019"; anything that is not a date stays as it is.
std::string date_text(const std::string& date);
/// The same with the scan's name: "11 Feb 2019, veraison".
std::string scan_label(const ScanProduct& scan);
/// A row by number and, where it has one, name.
std::string row_text(const BlockProducts& block, int row_number);
/// "7" for one panel, "4 to 6" for several.
std::string panels_text(const WeakStretch& stretch);

/// HTML of a text: escaped, with numbers and their units on one line.
std::string words_html(const std::string& text);

/// A number with a proper minus sign; "not observed" for NaN.
std::string number(double value, int digits);
std::string signed_number(double value, int digits);

}  // namespace rayfield::formats
