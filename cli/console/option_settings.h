#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "rayfield/core/option_fields.h"
#include "rayfield/core/result.h"

namespace rayfield::cli {

/// The options of an algorithm that have no flag of their own (docs/options.md): `--set KEY=VALUE`, or tables below the
/// command's in a configuration file ([process.posts] min_contrast = 2.5).
void add_settings_option(CLI::App& command, std::vector<std::string>& settings);

/// "true" and "false", numbers, lists of numbers in brackets; all else is text.
OptionValue parse_option_value(const std::string& text);

/// "key=value" cut at the first '='. Errors: usage.
Result<std::pair<std::string, OptionValue>> parse_setting(const std::string& setting);

/// For a flag that stands for the option `key`: refuses what --set would refuse, in the same words.
template <class Options>
CLI::Validator valid_for(const std::string& key) {
  const auto check = [key](const std::string& text) {
    Options options;
    const Result<void> set = set_option(options, key, parse_option_value(text), "bad option");
    return set ? std::string() : set.error().why;
  };
  return CLI::Validator(check, "");
}

/// Adds to the error of an unknown key the key that was probably meant; other errors stay as they are.
Error with_similar_key(Error error, const std::vector<OptionDescription>& options);

/// Applies settings in their order. Errors: usage, with the key.
template <class Options>
Result<void> apply_settings(const std::vector<std::string>& settings, Options& options) {
  for (const std::string& setting : settings) {
    RAYFIELD_ASSIGN(const auto parsed, parse_setting(setting));
    if (Result<void> set = set_option(options, parsed.first, parsed.second, "bad --set"); !set)
      return tl::make_unexpected(with_similar_key(std::move(set).error(), describe_options<Options>()));
  }
  return {};
}

}  // namespace rayfield::cli
