#include "formats/report/report_words.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "formats/io/text_escape.h"

namespace rayfield::formats {

std::string date_text(const std::string& date) {
  constexpr std::array<const char*, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                   "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  int month = 0, day = 0;
  if (date.size() != 10) return date;
  std::from_chars(date.data() + 5, date.data() + 7, month);
  std::from_chars(date.data() + 8, date.data() + 10, day);
  if (month < 1 || month > 12 || day < 1) return date;
  return fmt::format("{} {} {}", day, kMonths.at(static_cast<std::size_t>(month - 1)), date.substr(0, 4));
}

std::string scan_label(const ScanProduct& scan) {
  return scan.name.empty() ? date_text(scan.scan_date) : date_text(scan.scan_date) + ", " + scan.name;
}

std::string row_text(const BlockProducts& block, int row_number) {
  for (const RowProduct& row : block.rows)
    if (row.row_number == row_number && !row.row_name.empty())
      return fmt::format("Row {} ({})", row_number, row.row_name);
  return fmt::format("Row {}", row_number);
}

std::string panels_text(const WeakStretch& stretch) {
  return stretch.first_panel == stretch.last_panel
             ? fmt::format("panel {}", stretch.first_panel)
             : fmt::format("panels {} to {}", stretch.first_panel, stretch.last_panel);
}

std::string words_html(const std::string& text) {
  std::string html = xml_escape(text);
  for (const std::string_view unit : {" %", " m²"})
    for (std::size_t at = html.find(unit); at != std::string::npos; at = html.find(unit, at))
      html.replace(at, 1, "\xC2\xA0");  // no-break space
  return html;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "not observed";
  const std::string text = fmt::format("{:.{}f}", std::abs(value), digits);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !zero ? "−" + text : text;
}

std::string signed_number(double value, int digits) {
  const std::string text = number(value, digits);
  return std::isfinite(value) && text[0] >= '0' && text[0] <= '9' && text.find_first_not_of("0.") != std::string::npos
             ? "+" + text
             : text;
}

}  // namespace rayfield::formats
