#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rayfield/core/result.h"

/// options: options are written once. A struct gives its members' defaults and, in one function template, the valid
/// range and meaning of every member:
///
///   struct SurveyOptions {
///     double ground_cell_m = 0.25;
///     int ground_bins = 48;
///     template <class Self, class Visitor>
///     static void visit_fields(Self& o, Visitor& v) {
///       v.number("ground_cell_m", o.ground_cell_m, {0.05, 1}, "Cells of the low histograms; smaller = finer ground");
///       v.integer("ground_bins", o.ground_bins, {8, 200}, "Lowest occupied bins kept per cell; bounds memory");
///     }
///   };
///
/// Validation, cache keys, configuration files and the documentation (docs/options.md) all go through it. Units stand
/// in the keys. Tests compare the number of fields with the number of members, so that none is left out.
namespace rayfield {

/// Valid values, both bounds included; NaN never is.
struct OptionRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool contains(double value) const { return value >= low && value <= high; }
};
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Names of an enumeration's values.
template <class E, std::size_t N>
using OptionChoices = std::array<std::pair<std::string_view, E>, N>;

/// A value as configuration files give it.
using OptionValue = std::variant<bool, double, std::string, std::vector<double>>;

/// One option as documentation shows it.
struct OptionDescription {
  std::string key;  ///< with its groups, "rows.drives.spacing_m"
  std::string default_value, range, meaning;
};

namespace option_fields {

// How ranges and values are written in messages and documentation.
std::string range_text(const OptionRange& range);
std::string number_text(double value);

// Common part of visitors: the dotted prefix of groups.
class GroupedVisitor {
 public:
  template <class Visitor, class Options>
  void visit_group(Visitor& visitor, std::string_view key, Options& options) {
    const std::size_t size = prefix_.size();
    prefix_.append(key).append(".");
    std::remove_const_t<Options>::visit_fields(options, visitor);
    prefix_.resize(size);
  }
  std::string name(std::string_view key) const { return prefix_ + std::string(key); }

 private:
  std::string prefix_;
};

// Keeps the first value that is out of its range.
class RangeChecker : public GroupedVisitor {
 public:
  std::string where, why;

  void number(std::string_view key, double value, const OptionRange& range, std::string_view) {
    if (where.empty() && !range.contains(value)) complain(key, value, range);
  }
  void integer(std::string_view key, int value, const OptionRange& range, std::string_view) {
    number(key, value, range, {});
  }
  void optional_number(std::string_view key, const std::optional<double>& value, const OptionRange& range,
                       std::string_view) {
    if (value) number(key, *value, range, {});
  }
  void numbers(std::string_view key, const std::vector<double>& values, const OptionRange& range, std::size_t most,
               std::string_view);
  void flag(std::string_view, bool, std::string_view) {}
  void text(std::string_view, const std::string&, std::string_view) {}
  template <class E, std::size_t N>
  void choice(std::string_view, const E&, const OptionChoices<E, N>&, std::string_view) {}
  template <class Options>
  void group(std::string_view key, const Options& options) {
    visit_group(*this, key, options);
  }

 private:
  void complain(std::string_view key, double value, const OptionRange& range);
};

// All values as numbers, in the order of the fields: what a cache key is made of.
class NumberCollector {
 public:
  std::vector<double> values;

  void number(std::string_view, double value, const OptionRange&, std::string_view) { values.push_back(value); }
  void integer(std::string_view, int value, const OptionRange&, std::string_view) { values.push_back(value); }
  void optional_number(std::string_view, const std::optional<double>& value, const OptionRange&, std::string_view) {
    values.push_back(value.value_or(std::numeric_limits<double>::infinity()));
  }
  void numbers(std::string_view, const std::vector<double>& list, const OptionRange&, std::size_t, std::string_view) {
    values.push_back(static_cast<double>(list.size()));
    values.insert(values.end(), list.begin(), list.end());
  }
  void flag(std::string_view, bool value, std::string_view) { values.push_back(value ? 1 : 0); }
  void text(std::string_view, const std::string&, std::string_view) {}  // folders and names change no result
  template <class E, std::size_t N>
  void choice(std::string_view, const E& value, const OptionChoices<E, N>&, std::string_view) {
    values.push_back(static_cast<double>(value));
  }
  template <class Options>
  void group(std::string_view, const Options& options) {
    Options::visit_fields(options, *this);
  }
};

// Describes every field.
class Describer : public GroupedVisitor {
 public:
  std::vector<OptionDescription> fields;

  void number(std::string_view key, double value, const OptionRange& range, std::string_view meaning) {
    add(key, number_text(value), range_text(range), meaning);
  }
  void integer(std::string_view key, int value, const OptionRange& range, std::string_view meaning) {
    add(key, std::to_string(value), range_text(range), meaning);
  }
  void optional_number(std::string_view key, const std::optional<double>& value, const OptionRange& range,
                       std::string_view meaning) {
    add(key, value ? number_text(*value) : "none", range_text(range), meaning);
  }
  void numbers(std::string_view key, const std::vector<double>& values, const OptionRange& range, std::size_t most,
               std::string_view meaning);
  void flag(std::string_view key, bool value, std::string_view meaning) {
    add(key, value ? "true" : "false", "true, false", meaning);
  }
  void text(std::string_view key, const std::string& value, std::string_view meaning) {
    add(key, "\"" + value + "\"", "text", meaning);
  }
  template <class E, std::size_t N>
  void choice(std::string_view key, const E& value, const OptionChoices<E, N>& choices, std::string_view meaning) {
    std::string now, all;
    for (const auto& [text, choice] : choices) {
      if (choice == value) now = text;
      all.append(all.empty() ? "" : ", ").append(text);
    }
    add(key, now, all, meaning);
  }
  template <class Options>
  void group(std::string_view key, const Options& options) {
    visit_group(*this, key, options);
  }

 private:
  void add(std::string_view key, std::string value, std::string range, std::string_view meaning) {
    fields.push_back({name(key), std::move(value), std::move(range), std::string(meaning)});
  }
};

// Sets the field of one name.
class Setter : public GroupedVisitor {
 public:
  Setter(std::string_view wanted, const OptionValue& value) : wanted_(wanted), value_(value) {}
  bool found = false;
  std::string why;  // what is wrong with the value; empty: nothing

  void number(std::string_view key, double& value, const OptionRange& range, std::string_view) {
    if (const auto given = take_number(key, range)) value = *given;
  }
  void integer(std::string_view key, int& value, const OptionRange& range, std::string_view);
  void optional_number(std::string_view key, std::optional<double>& value, const OptionRange& range, std::string_view) {
    if (const auto given = take_number(key, range)) value = given;
  }
  void numbers(std::string_view key, std::vector<double>& values, const OptionRange& range, std::size_t most,
               std::string_view);
  void flag(std::string_view key, bool& value, std::string_view);
  void text(std::string_view key, std::string& value, std::string_view);
  template <class E, std::size_t N>
  void choice(std::string_view key, E& value, const OptionChoices<E, N>& choices, std::string_view) {
    if (!take(key)) return;
    std::string all;
    for (const auto& [text, choice] : choices) {
      const auto* given = std::get_if<std::string>(&value_);
      if (given != nullptr && *given == text) {
        value = choice;
        return;
      }
      all.append(all.empty() ? "" : ", ").append(text);
    }
    why = "it must be one of: " + all;
  }
  template <class Options>
  void group(std::string_view key, Options& options) {
    visit_group(*this, key, options);
  }

 private:
  bool take(std::string_view key);
  std::optional<double> take_number(std::string_view key, const OptionRange& range);

  std::string_view wanted_;
  const OptionValue& value_;
};

tl::unexpected<Error> unknown_option(std::string_view what, std::string_view key);

}  // namespace option_fields

/// Errors: usage, with the key of the first value that is out of range.
template <class Options>
Result<void> check_option_ranges(const Options& options, std::string_view what) {
  option_fields::RangeChecker checker;
  Options::visit_fields(options, checker);
  if (checker.where.empty()) return {};
  return fail(ErrorCode::usage, what, checker.where, checker.why, "see docs/options.md");
}

/// Every value as a number, in the order of the fields.
template <class Options>
std::vector<double> option_numbers(const Options& options) {
  option_fields::NumberCollector collector;
  Options::visit_fields(options, collector);
  return std::move(collector.values);
}

/// Every option with its default, range and meaning, in the order of the fields.
template <class Options>
std::vector<OptionDescription> describe_options(const Options& options = {}) {
  option_fields::Describer describer;
  Options::visit_fields(options, describer);
  return std::move(describer.fields);
}

/// Sets the option with that (dotted) key. Errors: usage, if there is none, or if the value has the wrong type or is
/// out of range.
template <class Options>
Result<void> set_option(Options& options, std::string_view key, const OptionValue& value, std::string_view what) {
  option_fields::Setter setter(key, value);
  Options::visit_fields(options, setter);
  if (!setter.found) return option_fields::unknown_option(what, key);
  if (!setter.why.empty()) return fail(ErrorCode::usage, what, key, setter.why, "see docs/options.md");
  return {};
}

}  // namespace rayfield
