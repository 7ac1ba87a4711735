#include "cli/console/suggestion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

namespace rayfield::cli {
namespace {

std::string folded(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Optimal string alignment distance, by rows; two rows back for neighbours that are swapped.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

}  // namespace

std::optional<std::string> similar_word(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string wanted = folded(word);
  std::size_t least = std::max<std::size_t>(1, wanted.size() / 3) + 1;
  std::optional<std::string> nearest;
  std::vector<std::string> longer;
  for (const std::string& candidate : candidates) {
    const std::string name = folded(candidate);
    if (const std::size_t mistakes = distance(wanted, name); mistakes < least) least = mistakes, nearest = candidate;
    if (wanted.size() >= 2 && name.size() > wanted.size() && name.compare(0, wanted.size(), wanted) == 0)
      longer.push_back(candidate);
  }
  if (longer.size() == 1 && least > 1) return longer.front();
  return nearest;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates, std::string_view prefix,
                       std::string_view help) {
  const auto similar = similar_word(word, candidates);
  return similar ? fmt::format("did you mean {}{}? see {}", prefix, *similar, help) : fmt::format("see {}", help);
}

}  // namespace rayfield::cli
