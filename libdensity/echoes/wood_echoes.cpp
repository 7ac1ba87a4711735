#include "libdensity/echoes/wood_echoes.h"

#include <algorithm>
#include <cmath>

namespace rayfield::density {
namespace {

constexpr std::int64_t kEnoughOnPosts = 200;
constexpr double kMissing = 4.0, kMissingPower = 3, kLeastReturned = 0.25;
constexpr double kError = 0.3, kErrorOfMissing = 0.4;

}  // namespace

std::optional<WoodEchoes> wood_echoes(const EchoStatistics& statistics, double mean, double weakest) {
  if (statistics.wood().count < kEnoughOnPosts || !(weakest > 0) || !(mean > 0)) return std::nullopt;
  const double above_weakest = std::max(1.0, mean / weakest);
  const double returned = std::max(kLeastReturned, std::exp(-kMissing / std::pow(above_weakest, kMissingPower)));
  return WoodEchoes{statistics.wood().mean(), returned, std::hypot(kError, kErrorOfMissing * std::log(returned))};
}

}  // namespace rayfield::density
