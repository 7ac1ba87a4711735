#include "libdensity/echoes/wood_echoes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace rayfield::density {
namespace {

constexpr std::int64_t kEnoughOnPosts = 200, kEnoughOnTrunks = 200;
constexpr std::uint64_t kEnoughToCompare = 100;
constexpr double kBrightShare = 0.95;  // of the echoes on trunks, or posts, are weaker than the bright ones
constexpr double kDarkestTrunks = 0.4, kBrightestTrunks = 2.5;  // over posts
constexpr double kMissing = 3.3, kMissingPower = 3, kLeastReturned = 0.25;
constexpr double kDarkestWood = 0.4, kBrightestWood = 1.6;  // over leaves
constexpr double kEchoesOfBareVines = 2.5;                  // for each of a beam that falls wholly on a post or trunk
constexpr double kWoodNotKnown = 0.6;                       // of how much there is, two of three times: a factor of 1.8
constexpr double kPastTrunks = 1.10, kPastTrunksError = 0.06;  // measured: of full echoes on trunks part went past them
constexpr double kDarknessNotKnown = 0.3;  // where nothing tells: wood is as bright as leaves, or 0.6 times
constexpr double kPartNotKnown = 0.15;     // of wood among the echoes where hardly a stem is seen: as at half leaf
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

WoodBrightness wood_brightness(const EchoStatistics& statistics, double full_echo) {
  const auto beside_leaves = [&](double wood) { return std::clamp(wood / full_echo, kDarkestWood, kBrightestWood); };
  if (const auto of_trunks = full_echo_of_trunks(statistics)) return {beside_leaves(*of_trunks), 0};
  const EchoStatistics::Sum& on_trunks = statistics.trunks().full;
  if (on_trunks.count >= kEnoughOnTrunks) return {beside_leaves(kPastTrunks * on_trunks.mean()), kPastTrunksError};
  return {1, kDarknessNotKnown};
}

double wood_error(const EchoStatistics& statistics, double full_echo) {
  if (statistics.echoes() == 0) return 0;
  const std::int64_t on_stems = statistics.wood().count;
  const double part = on_stems < kEnoughOnPosts ? kPartNotKnown
                                                : std::min(1.0, kEchoesOfBareVines * static_cast<double>(on_stems) /
                                                                    static_cast<double>(statistics.echoes()));
  const WoodBrightness brightness = wood_brightness(statistics, full_echo);
  return part * std::hypot(kWoodNotKnown * (1 - brightness.value), brightness.error);
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
