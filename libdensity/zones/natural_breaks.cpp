#include "libdensity/zones/natural_breaks.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

namespace rayfield::density {
namespace {

constexpr int kBins = 1024;

// Values that fell into one bin.
struct Bin {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  double weight = 0, sum = 0, squares = 0;
};

std::vector<Bin> binned(std::span<const double> values, std::span<const double> weights) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double width = (*high - *low) / kBins;
  std::vector<Bin> bins(kBins);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double place = width > 0 ? (values[i] - *low) / width : 0;
    Bin& bin = bins[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))];
    bin.low = std::min(bin.low, values[i]), bin.high = std::max(bin.high, values[i]);
    // About the lowest value, so that squares do not cancel.
    const double v = values[i] - *low;
    bin.weight += weights[i], bin.sum += weights[i] * v, bin.squares += weights[i] * v * v;
  }
  std::erase_if(bins, [](const Bin& bin) { return bin.weight <= 0; });
  return bins;
}

// Squared deviations from their mean of bins first … last − 1, from running sums.
class Deviations {
 public:
  explicit Deviations(const std::vector<Bin>& bins) : sums_(bins.size() + 1) {
    for (std::size_t i = 0; i < bins.size(); ++i) {
      sums_[i + 1].weight = sums_[i].weight + bins[i].weight;
      sums_[i + 1].sum = sums_[i].sum + bins[i].sum;
      sums_[i + 1].squares = sums_[i].squares + bins[i].squares;
    }
  }
  double operator()(std::size_t first, std::size_t last) const {
    const double weight = sums_[last].weight - sums_[first].weight, sum = sums_[last].sum - sums_[first].sum;
    return std::max(sums_[last].squares - sums_[first].squares - sum * sum / weight, 0.0);
  }

 private:
  std::vector<Bin> sums_;
};

}  // namespace

// Fisher's recursion: the best k classes of the first n bins are the best k − 1 classes of the first j and one class of
// the rest, for the best j.
Result<std::vector<double>> natural_breaks(std::span<const double> values, std::span<const double> weights,
                                           int classes) {
  const std::vector<Bin> bins = values.empty() ? std::vector<Bin>() : binned(values, weights);
  const auto count = static_cast<std::size_t>(classes), n = bins.size();
  if (n < count)
    return fail(ErrorCode::bad_input, "cannot make zones", "",
                fmt::format("{} different values make no {} classes", n, classes), "give fewer --classes");
  const Deviations deviations(bins);
  std::vector<double> best(n + 1, std::numeric_limits<double>::infinity());
  best[0] = 0;
  std::vector<std::vector<std::size_t>> begins(count, std::vector<std::size_t>(n + 1, 0));
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> next(n + 1, std::numeric_limits<double>::infinity());
    for (std::size_t end = k + 1; end <= n; ++end)
      for (std::size_t begin = k; begin < end; ++begin)
        if (const double sum = best[begin] + deviations(begin, end); sum < next[end])
          next[end] = sum, begins[k][end] = begin;
    best = std::move(next);
  }
  std::vector<double> breaks;
  std::size_t end = n;
  for (std::size_t k = count; k-- > 1;) {
    end = begins[k][end];
    breaks.push_back((bins[end - 1].high + bins[end].low) / 2);
  }
  std::reverse(breaks.begin(), breaks.end());
  return breaks;
}

}  // namespace rayfield::density
