#include "cli/console/option_settings.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "cli/console/suggestion.h"

namespace rayfield::cli {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

void add_settings_option(CLI::App& command, std::vector<std::string>& settings) {
  command
      .add_option("--set", settings,
                  "Any option of docs/options.md, e.g. --set posts.min_contrast=2.5; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);  // what follows KEY=VALUE is not another one
}

OptionValue parse_option_value(const std::string& text) {
  const std::string_view value = trimmed(text);
  if (value == "true" || value == "false") return value == "true";
  if (const auto number = number_of(value)) return *number;
  if (value.size() < 2 || value.front() != '[' || value.back() != ']') return text;
  std::vector<double> numbers;
  std::string_view rest = value.substr(1, value.size() - 2);
  while (!trimmed(rest).empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const auto number = number_of(trimmed(rest.substr(0, comma)));
    if (!number) return text;
    numbers.push_back(*number);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return numbers;
}

Result<std::pair<std::string, OptionValue>> parse_setting(const std::string& setting) {
  const std::size_t cut = setting.find('=');
  if (cut == std::string::npos || cut == 0)
    return fail(ErrorCode::usage, "bad --set", setting, "it is not KEY=VALUE",
                "give e.g. --set posts.min_contrast=2.5; docs/options.md lists the keys");
  return std::pair(std::string(trimmed(std::string_view(setting).substr(0, cut))),
                   parse_option_value(setting.substr(cut + 1)));
}

Error with_similar_key(Error error, const std::vector<OptionDescription>& options) {
  std::vector<std::string> keys;
  for (const OptionDescription& option : options) keys.push_back(option.key);
  if (std::find(keys.begin(), keys.end(), error.where) == keys.end())
    error.next = suggestion(error.where, keys, "", "docs/options.md");
  return error;
}

}  // namespace rayfield::cli
