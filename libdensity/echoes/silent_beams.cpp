#include "libdensity/echoes/silent_beams.h"

#include <algorithm>
#include <cstddef>

namespace rayfield::density {
namespace {

constexpr std::int64_t kEnoughOpen = 100, kEnoughThrough = 2000;
constexpr double kMostUnanswered = 0.3;  // by open ground
constexpr double kMostSilent = 0.5;

}  // namespace

void SilentBeams::add(double cosine, bool through_row, Outcome outcome) {
  const int bin = std::clamp(static_cast<int>(cosine * kCosines), 0, kCosines - 1);
  Count& count = (through_row ? through_ : open_)[static_cast<std::size_t>(bin)];
  if (outcome == Outcome::ground) ++count.ground;
  if (outcome == Outcome::nothing) ++count.nothing;
  if (outcome == Outcome::row) ++count.row;
}

SilentBeams& SilentBeams::operator+=(const SilentBeams& other) {
  const auto add = [](Count& mine, const Count& theirs) {
    mine.ground += theirs.ground, mine.nothing += theirs.nothing, mine.row += theirs.row;
  };
  for (std::size_t i = 0; i < kCosines; ++i) add(open_[i], other.open_[i]), add(through_[i], other.through_[i]);
  return *this;
}

std::optional<double> SilentBeams::share() const {
  std::int64_t beams = 0;
  double silent = 0;
  for (std::size_t i = 0; i < kCosines; ++i) {
    const Count &open = open_[i], &through = through_[i];
    const std::int64_t opens = open.ground + open.nothing;
    if (opens < kEnoughOpen) continue;
    const double unanswered = static_cast<double>(open.nothing) / static_cast<double>(opens);
    if (unanswered > kMostUnanswered) continue;
    beams += through.ground + through.nothing + through.row;
    silent +=
        static_cast<double>(through.nothing) - static_cast<double>(through.ground) * unanswered / (1 - unanswered);
  }
  if (beams < kEnoughThrough) return std::nullopt;
  return std::clamp(silent / static_cast<double>(beams), 0.0, kMostSilent);
}

}  // namespace rayfield::density
