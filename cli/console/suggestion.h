#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayfield::cli {

/// The candidate that a mistyped word most likely stands for: the one with the fewest letters changed, added, left out
/// or swapped with their neighbour (optimal string alignment distance), a third of the word's letters at most and at
/// least one; else the only one that begins with the word. Case, and '_' for '-', count as no mistake.
std::optional<std::string> similar_word(std::string_view word, const std::vector<std::string>& candidates);

/// "did you mean `PREFIXword`? see HELP", or "see HELP" where nothing is similar.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates, std::string_view prefix,
                       std::string_view help);

}  // namespace rayfield::cli
