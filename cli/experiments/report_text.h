#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rayfield/experiments/moments.h"

namespace rayfield::cli {

/// A Markdown table whose columns are also aligned on a terminal.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> heads) : lines_{std::move(heads)} {}
  /// As many cells as there are heads.
  void add(std::vector<std::string> cells) { lines_.push_back(std::move(cells)); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> lines_;  // the first: heads
};

/// A share in per cent with its sign: 0.0312 → "+3.1".
std::string percent(double share, int digits = 1);
/// With the standard error: "+3.1 ± 0.2".
std::string percent(const experiments::Mean& mean, int digits = 1);

/// {"value": …, "standard_error": …}
nlohmann::ordered_json mean_json(const experiments::Mean& mean);

/// "- " before each, a line per note.
std::string notes_text(const std::vector<std::string>& notes);

}  // namespace rayfield::cli
