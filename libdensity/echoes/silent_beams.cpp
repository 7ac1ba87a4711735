#include "libdensity/echoes/silent_beams.h"

#include <algorithm>
#include <cstddef>

namespace rayfield::density {
namespace {

constexpr std::int64_t kEnoughOpen = 100, kEnoughThrough = 2000;
constexpr double kMostUnanswered = 0.3;  // by open ground
constexpr double kMostUsedUp = 0.5;
constexpr double kLeftOfWeakest = 0.75;

}  // namespace

void SilentBeams::add(double cosine, bool through_row, Outcome outcome, int intensity) {
  const int bin = std::clamp(static_cast<int>(cosine * kCosines), 0, kCosines - 1);
  Count& count = (through_row ? through_ : open_)[static_cast<std::size_t>(bin)];
  if (outcome == Outcome::ground) ++count.ground, count.ground_intensity += intensity;
  if (outcome == Outcome::nothing) ++count.nothing;
  if (outcome == Outcome::row) ++count.row;
}

SilentBeams& SilentBeams::operator+=(const SilentBeams& other) {
  const auto add = [](Count& mine, const Count& theirs) {
    mine.ground += theirs.ground, mine.nothing += theirs.nothing, mine.row += theirs.row;
    mine.ground_intensity += theirs.ground_intensity;
  };
  for (std::size_t i = 0; i < kCosines; ++i) add(open_[i], other.open_[i]), add(through_[i], other.through_[i]);
  return *this;
}

std::optional<double> SilentBeams::used_up(double weakest) const {
  std::int64_t beams = 0;
  double used = 0;
  for (std::size_t i = 0; i < kCosines; ++i) {
    const Count &open = open_[i], &through = through_[i];
    const std::int64_t opens = open.ground + open.nothing;
    if (opens < kEnoughOpen) continue;
    const double unanswered = static_cast<double>(open.nothing) / static_cast<double>(opens);
    if (unanswered > kMostUnanswered) continue;
    const double silent =
        static_cast<double>(through.nothing) - static_cast<double>(through.ground) * unanswered / (1 - unanswered);
    const double of_ground = static_cast<double>(open.ground_intensity) / static_cast<double>(open.ground);
    used += silent * std::max(0.0, 1 - kLeftOfWeakest * weakest / of_ground);
    beams += through.ground + through.nothing + through.row;
  }
  if (beams < kEnoughThrough) return std::nullopt;
  return std::clamp(used / static_cast<double>(beams), 0.0, kMostUsedUp);
}

}  // namespace rayfield::density
