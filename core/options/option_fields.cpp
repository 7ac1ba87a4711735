#include "rayfield/core/option_fields.h"

#include <fmt/core.h>

#include <cmath>

namespace rayfield::option_fields {

std::string number_text(double value) { return fmt::format("{}", value); }

std::string range_text(const OptionRange& range) {
  const bool below = std::isfinite(range.low), above = std::isfinite(range.high);
  if (below && above) return fmt::format("{} … {}", range.low, range.high);
  if (below) return fmt::format("≥ {}", range.low);
  if (above) return fmt::format("≤ {}", range.high);
  return "any";
}

void RangeChecker::complain(std::string_view key, double value, const OptionRange& range) {
  where = name(key);
  why = fmt::format("{} is outside {}", value, range_text(range));
}

void RangeChecker::numbers(std::string_view key, const std::vector<double>& values, const OptionRange& range,
                           std::size_t most, std::string_view) {
  if (where.empty() && (values.empty() || values.size() > most)) {
    where = name(key);
    why = fmt::format("1 to {} values are needed", most);
  }
  for (const double value : values) number(key, value, range, {});
}

void Describer::numbers(std::string_view key, const std::vector<double>& values, const OptionRange& range,
                        std::size_t most, std::string_view meaning) {
  std::string list;
  for (const double value : values) list.append(list.empty() ? "" : ", ").append(number_text(value));
  add(key, "[" + list + "]", fmt::format("1 to {} values of {}", most, range_text(range)), meaning);
}

bool Setter::take(std::string_view key) {
  if (name(key) != wanted_) return false;
  found = true;
  return true;
}

std::optional<double> Setter::take_number(std::string_view key, const OptionRange& range) {
  if (!take(key)) return std::nullopt;
  const double* given = std::get_if<double>(&value_);
  if (given == nullptr) {
    why = "it must be a number";
  } else if (!range.contains(*given)) {
    why = fmt::format("{} is outside {}", *given, range_text(range));
  } else {
    return *given;
  }
  return std::nullopt;
}

void Setter::integer(std::string_view key, int& value, const OptionRange& range, std::string_view) {
  const auto given = take_number(key, range);
  if (!given) return;
  if (*given != std::floor(*given) || std::abs(*given) > 2147483647.0)
    why = "it must be a whole number";
  else
    value = static_cast<int>(*given);
}

void Setter::numbers(std::string_view key, std::vector<double>& values, const OptionRange& range, std::size_t most,
                     std::string_view) {
  if (!take(key)) return;
  const auto* given = std::get_if<std::vector<double>>(&value_);
  if (given == nullptr || given->empty() || given->size() > most) {
    why = fmt::format("it must be a list of 1 to {} numbers", most);
    return;
  }
  for (const double number : *given)
    if (!range.contains(number)) why = fmt::format("{} is outside {}", number, range_text(range));
  if (why.empty()) values = *given;
}

void Setter::flag(std::string_view key, bool& value, std::string_view) {
  if (!take(key)) return;
  if (const bool* given = std::get_if<bool>(&value_))
    value = *given;
  else
    why = "it must be true or false";
}

void Setter::text(std::string_view key, std::string& value, std::string_view) {
  if (!take(key)) return;
  if (const auto* given = std::get_if<std::string>(&value_))
    value = *given;
  else
    why = "it must be a string";
}

tl::unexpected<Error> unknown_option(std::string_view what, std::string_view key) {
  return fail(ErrorCode::usage, what, key, "there is no such option", "see docs/options.md");
}

}  // namespace rayfield::option_fields
