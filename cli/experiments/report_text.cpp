#include "cli/experiments/report_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rayfield::cli {
namespace {

/// Characters of UTF-8: bytes that do not continue one.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string TextTable::text() const {
  std::vector<std::size_t> widths(lines_.front().size(), 3);
  for (const auto& line : lines_)
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], width_of(line[i]));
  std::string out;
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    out += "|";
    for (std::size_t i = 0; i < lines_[l].size(); ++i)
      out += " " + lines_[l][i] + std::string(widths[i] - width_of(lines_[l][i]), ' ') + " |";
    out += "\n";
    if (l > 0) continue;
    out += "|";
    for (const std::size_t width : widths) out += std::string(width + 2, '-') + "|";
    out += "\n";
  }
  return out;
}

std::string percent(double share, int digits) {
  const std::string number = fmt::format("{:.{}f}", std::abs(100 * share), digits);
  const bool zero = number.find_first_not_of("0.") == std::string::npos;
  return zero ? number : (share < 0 ? "−" : "+") + number;
}

std::string percent(const experiments::Mean& mean, int digits) {
  return fmt::format("{} ± {:.{}f}", percent(mean.value, digits), 100 * mean.standard_error, digits);
}

nlohmann::ordered_json mean_json(const experiments::Mean& mean) {
  return {{"value", mean.value}, {"standard_error", mean.standard_error}};
}

std::string notes_text(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += "- " + note + "\n";
  return text;
}

}  // namespace rayfield::cli
