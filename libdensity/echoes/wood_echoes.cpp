#include "libdensity/echoes/wood_echoes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace rayfield::density {
namespace {

constexpr std::int64_t kEnoughOnPosts = 200;
constexpr std::uint64_t kEnoughToCompare = 100;
constexpr double kBrightShare = 0.95;  // of the echoes on trunks, or posts, are weaker than the bright ones
constexpr double kDarkestTrunks = 0.4, kBrightestTrunks = 2.5;  // over posts
constexpr double kMissing = 3.3, kMissingPower = 3, kLeastReturned = 0.25;
constexpr double kDarkestWood = 0.4, kBrightestWood = 1.6;  // over leaves
constexpr double kEchoesOfBareVines = 2.5;                  // for each of a beam that falls wholly on a post or trunk
constexpr double kWoodNotKnown = 0.6;                       // of how much there is, two of three times: a factor of 1.8
constexpr double kError = 0.15, kErrorOfMissing = 0.3;

std::uint64_t echoes_on(const EchoStatistics::Stems& stems) {
  return std::accumulate(stems.histogram.begin(), stems.histogram.end(), std::uint64_t{0});
}

double trunks_over_posts(const EchoStatistics& statistics) {
  const double trunks = strength_quantile(statistics.trunks().histogram, kBrightShare);
  const double posts = strength_quantile(statistics.posts().histogram, kBrightShare);
  return posts > 0 ? std::clamp(trunks / posts, kDarkestTrunks, kBrightestTrunks) : 1;
}

/// Of beams that fall wholly on wood like that of the trunks. Nothing: echoes of trunks are too few.
std::optional<double> full_echo_of_trunks(const EchoStatistics& statistics) {
  const auto least = std::min(echoes_on(statistics.trunks()), echoes_on(statistics.posts()));
  if (least >= kEnoughToCompare && statistics.posts().full.count >= kEnoughOnPosts)
    return statistics.posts().full.mean() * trunks_over_posts(statistics);
  return std::nullopt;
}

}  // namespace

double wood_brightness(const EchoStatistics& statistics, double full_echo) {
  const std::optional<double> of_trunks = full_echo_of_trunks(statistics);
  return of_trunks ? std::clamp(*of_trunks / full_echo, kDarkestWood, kBrightestWood) : 1;
}

double wood_error(const EchoStatistics& statistics, double full_echo) {
  if (statistics.echoes() == 0) return 0;
  const double part = std::min(1.0, kEchoesOfBareVines * static_cast<double>(statistics.wood().count) /
                                        static_cast<double>(statistics.echoes()));
  return kWoodNotKnown * part * std::abs(1 - wood_brightness(statistics, full_echo));
}

std::optional<WoodEchoes> wood_echoes(const EchoStatistics& statistics, double mean, double weakest) {
  const EchoStatistics::Sum wood = statistics.wood();
  if (wood.count < kEnoughOnPosts || !(weakest > 0) || !(mean > 0)) return std::nullopt;
  const double full_echo = full_echo_of_trunks(statistics).value_or(wood.mean());
  const double above_weakest = std::max(1.0, mean / weakest);
  const double returned = std::max(kLeastReturned, std::exp(-kMissing / std::pow(above_weakest, kMissingPower)));
  return WoodEchoes{full_echo, returned, std::hypot(kError, kErrorOfMissing * std::log(returned))};
}

}  // namespace rayfield::density
