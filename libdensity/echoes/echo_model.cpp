#include "libdensity/echoes/echo_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rayfield::density {
namespace {

constexpr std::uint64_t kEnoughEchoes = 5000;
constexpr std::int64_t kEnoughInner = 500;
constexpr double kNearShare = 0.3;           // of the inner echoes: those of the narrowest beams
constexpr double kInnerError = 0.06;         // relative, of their mean as a full echo
constexpr double kDrawnOutError = 0.5;       // of the way from the nearest echoes to the drawn-out value
constexpr double kLeastDrawnOutError = 0.02;
constexpr double kSmearM = 0.054, kSmearPower = 1.5;  // of the apparent side of leaves
constexpr double kOnsetSmoothing = 0.04;              // of the intensity, either way

struct Mean {
  double value = 0, variance = 0;  ///< variance: of what it is off by
};

double width_of(int bin) { return (bin + 0.5) * EchoStatistics::kWidthStepM; }

/// Mean over the narrowest beams: as many bins as hold `share` of the echoes.
EchoStatistics::Sum narrowest(const std::array<EchoStatistics::Sum, EchoStatistics::kWidthBins>& bins, double share) {
  std::int64_t total = 0;
  for (const auto& bin : bins) total += bin.count;
  EchoStatistics::Sum sum;
  for (const auto& bin : bins) {
    if (static_cast<double>(sum.count) >= share * static_cast<double>(total)) break;
    sum.add(bin.count, bin.intensity);
  }
  return sum;
}

/// The mean echo at no width, by a straight line through the bins' means weighted with their numbers.
std::optional<double> drawn_out(const EchoStatistics& statistics) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (int b = 0; b < EchoStatistics::kWidthBins; ++b) {
    const EchoStatistics::Sum& bin = statistics.all()[static_cast<std::size_t>(b)];
    const auto count = static_cast<double>(bin.count), sum = static_cast<double>(bin.intensity);
    n += count, x += count * width_of(b), y += sum;
    xx += count * width_of(b) * width_of(b), xy += sum * width_of(b);
  }
  const double spread = n * xx - x * x;
  if (!(spread > 0)) return std::nullopt;
  return (y * xx - x * xy) / spread;
}

double mean_width(const EchoStatistics& statistics) {
  double n = 0, sum = 0;
  for (int b = 0; b < EchoStatistics::kWidthBins; ++b) {
    const auto count = static_cast<double>(statistics.all()[static_cast<std::size_t>(b)].count);
    n += count, sum += count * width_of(b);
  }
  return n > 0 ? sum / n : 0;
}

/// Intensity at which echoes set in: half of the greatest number per unit.
double onset_of(const std::vector<std::uint32_t>& histogram) {
  std::vector<double> below(histogram.size() + 1, 0);  // running sum
  for (std::size_t i = 0; i < histogram.size(); ++i) below[i + 1] = below[i] + histogram[i];
  // Number per unit around an intensity. Intensities are whole numbers: windows run from half to half.
  const auto density = [&](std::size_t i) {
    const auto reach = static_cast<std::size_t>(kOnsetSmoothing * static_cast<double>(i));
    const std::size_t low = i - std::min(i, reach), high = std::min(histogram.size(), i + reach + 1);
    return (below[high] - below[low]) / static_cast<double>(high - low);
  };
  double greatest = 0;
  for (std::size_t i = 1; i < histogram.size(); ++i) greatest = std::max(greatest, density(i));
  for (std::size_t i = 1; i < histogram.size(); ++i) {
    if (density(i) < greatest / 2) continue;
    const double before = density(i - 1), here = density(i);
    const double into = here > before ? (greatest / 2 - before) / (here - before) : 1;
    return static_cast<double>(i) - 1 + std::clamp(into, 0.0, 1.0);
  }
  return 0;
}

std::optional<Mean> full_echo_of(const EchoStatistics& statistics) {
  std::vector<Mean> found;
  const double near = narrowest(statistics.all(), kNearShare).mean();
  if (const auto thin = drawn_out(statistics); thin && *thin > 0) {
    const double error = std::max(kLeastDrawnOutError * *thin, kDrawnOutError * std::abs(*thin - near));
    found.push_back({*thin, error * error});
  }
  if (const auto inner = narrowest(statistics.inner(), kNearShare); inner.count >= kEnoughInner) {
    const double error = kInnerError * inner.mean();
    found.push_back({inner.mean(), error * error});
  }
  if (found.empty()) return std::nullopt;
  double weights = 0, sum = 0;
  for (const Mean& mean : found) weights += 1 / mean.variance, sum += mean.value / mean.variance;
  return Mean{sum / weights, 1 / weights};
}

double variation_of(const std::vector<std::uint32_t>& histogram) {
  double n = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    const double count = histogram[i], intensity = static_cast<double>(i);
    n += count, sum += count * intensity, squares += count * intensity * intensity;
  }
  return sum > 0 ? n * squares / (sum * sum) - 1 : 0;
}

}  // namespace

std::optional<EchoModel> estimate_echo_model(const EchoStatistics& statistics, const EchoKnowledge& known) {
  if (statistics.echoes() < kEnoughEchoes) return std::nullopt;
  EchoModel model{known.beam, known.range_resolution_m};
  model.echo_variation = variation_of(statistics.histogram());
  if (!(model.echo_variation > 1e-4)) return std::nullopt;  // a lidar that tells no intensity
  model.mean_width_m = mean_width(statistics);
  if (known.full_echo > 0) {
    model.full_echo = known.full_echo;
  } else {
    const auto full = full_echo_of(statistics);
    if (!full) return std::nullopt;
    model.full_echo = full->value, model.full_echo_error = std::sqrt(full->variance) / full->value;
  }
  model.detection_share = known.beam.detection_share.value_or(onset_of(statistics.histogram()) / model.full_echo);
  if (known.leaf_area_m2 >= 0) {
    model.leaf_area_m2 = known.leaf_area_m2, model.leaf_measured = true;
  } else {
    const LeafSize apparent = estimate_leaf_size(statistics.pairs_from(model.full_echo / 2));
    const double smear = 1 + std::pow(model.mean_width_m / kSmearM, kSmearPower);
    model.leaf_measured = apparent.measured;
    model.leaf_area_m2 = apparent.measured ? apparent.area_m2 / (smear * smear) : apparent.area_m2;
  }
  return model;
}

}  // namespace rayfield::density
