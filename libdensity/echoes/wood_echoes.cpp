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
constexpr double kEchoesOfBareVines = 2.5;  // for each of a beam that falls wholly on a post or trunk
constexpr double kError = 0.15, kErrorOfMissing = 0.3;

std::uint64_t echoes_on(const EchoStatistics::Stems& stems) {
  return std::accumulate(stems.histogram.begin(), stems.histogram.end(), std::uint64_t{0});
}

double trunks_over_posts(const EchoStatistics& statistics) {
  const double trunks = strength_quantile(statistics.trunks().histogram, kBrightShare);
  const double posts = strength_quantile(statistics.posts().histogram, kBrightShare);
  return posts > 0 ? std::clamp(trunks / posts, kDarkestTrunks, kBrightestTrunks) : 1;
}

/// Of beams that fall wholly on wood like that of the trunks.
double full_echo_of_trunks(const EchoStatistics& statistics) {
  const auto least = std::min(echoes_on(statistics.trunks()), echoes_on(statistics.posts()));
  if (least < kEnoughToCompare || statistics.posts().full.count < kEnoughOnPosts) return statistics.wood().mean();
  return statistics.posts().full.mean() * trunks_over_posts(statistics);
}

}  // namespace

std::optional<double> full_echo_of_wood(const EchoStatistics& statistics) {
  if (statistics.wood().count < kEnoughOnPosts) return std::nullopt;
  return full_echo_of_trunks(statistics);
}

double dark_wood_error(const EchoStatistics& statistics, double full_echo) {
  const std::optional<double> of_wood = full_echo_of_wood(statistics);
  if (!of_wood || statistics.echoes() == 0) return 0;
  const double part = std::min(1.0, kEchoesOfBareVines * static_cast<double>(statistics.wood().count) /
                                        static_cast<double>(statistics.echoes()));
  return part * std::max(0.0, 1 - *of_wood / full_echo);
}

std::optional<WoodEchoes> wood_echoes(const EchoStatistics& statistics, double mean, double weakest) {
  const std::optional<double> full_echo = full_echo_of_wood(statistics);
  if (!full_echo || !(weakest > 0) || !(mean > 0)) return std::nullopt;
  const double above_weakest = std::max(1.0, mean / weakest);
  const double returned = std::max(kLeastReturned, std::exp(-kMissing / std::pow(above_weakest, kMissingPower)));
  return WoodEchoes{*full_echo, returned, std::hypot(kError, kErrorOfMissing * std::log(returned))};
}

}  // namespace rayfield::density
