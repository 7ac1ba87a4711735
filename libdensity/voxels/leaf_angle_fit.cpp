#include "libdensity/voxels/leaf_angle_fit.h"

#include <algorithm>
#include <cmath>

#include "libdensity/voxels/leaf_angle.h"

namespace rayfield::density {
namespace {

using Bins = std::array<double, DirectionCounters::kBins>;

constexpr double kEnoughHits = 5000;
constexpr std::size_t kEnoughParts = 4;
constexpr double kLargestError = 0.3;
// Spherical leaves come out a little flat: the mean of ten sites with thin beams, −0.1 to 0.3 (docs/density.md).
constexpr double kSphericalLooks = 0.12;
// Above that: up to the first, leaves are taken for spherical, from the second on the ratio counts as it is found.
constexpr double kSurelyFlatter = 0.3, kCountsWhole = 0.7;

double ln_ratio_of(int i) { return DirectionLikelihood::kFirstLnRatio + i * DirectionLikelihood::kLnRatioStep; }

/// ln of what a unit of path meets in each bin, up to a factor, by ratio and loss.
struct Meetings {
  std::array<std::array<double, DirectionCounters::kSteepness>, DirectionLikelihood::kRatios> projection;
  std::array<std::array<double, DirectionCounters::kWidths>, DirectionLikelihood::kLosses> returned;
};

Meetings make_meetings() {
  Meetings out{};
  for (int r = 0; r < DirectionLikelihood::kRatios; ++r)
    for (std::size_t k = 0; k < DirectionCounters::kSteepness; ++k)
      out.projection[static_cast<std::size_t>(r)][k] =
          leaf_projection({LeafAngleType::ellipsoidal, std::exp(ln_ratio_of(r))}, DirectionCounters::kSine[k]);
  for (int l = 0; l < DirectionLikelihood::kLosses; ++l)
    for (std::size_t k = 0; k < DirectionCounters::kWidths; ++k)
      out.returned[static_cast<std::size_t>(l)][k] =
          std::exp(-l * DirectionLikelihood::kLossStepPerM * DirectionCounters::kWidth_m[k]);
  return out;
}

const Meetings& meetings() {
  static const Meetings kMeetings = make_meetings();
  return kMeetings;
}

/// Where the parabola through three values, one step apart, is greatest, in steps from the middle one.
double vertex(double before, double middle, double after) {
  const double curvature = before - 2 * middle + after;
  return curvature < 0 ? 0.5 * (before - after) / curvature : 0;
}

}  // namespace

void DirectionLikelihood::add(const DirectionCounters& voxel, double full_echo) {
  std::array<std::size_t, DirectionCounters::kBins> used{};
  std::size_t count = 0;
  Bins path{}, hits{};
  double all = 0;
  for (std::size_t i = 0; i < DirectionCounters::kBins; ++i) {
    if (voxel.path[i] <= 0) continue;
    path[i] = DirectionCounters::kPathUnit * static_cast<double>(voxel.path[i]);
    hits[i] = static_cast<double>(voxel.hits[i]) / full_echo;
    all += hits[i];
    used[count++] = i;
  }
  if (!(all > 0) || count < 2) return;
  hits_ += all;
  const Meetings& m = meetings();
  for (std::size_t r = 0; r < kRatios; ++r)
    for (std::size_t l = 0; l < kLosses; ++l) {
      double met = 0, ln = 0;
      for (std::size_t n = 0; n < count; ++n) {
        const std::size_t i = used[n];
        const double g =
            m.projection[r][i / DirectionCounters::kWidths] * m.returned[l][i % DirectionCounters::kWidths];
        met += path[i] * g;
        if (hits[i] > 0) ln += hits[i] * std::log(g);
      }
      ln_[r][l] += ln - all * std::log(met);
    }
}

DirectionLikelihood& DirectionLikelihood::operator+=(const DirectionLikelihood& other) {
  hits_ += other.hits_;
  for (std::size_t r = 0; r < kRatios; ++r)
    for (std::size_t l = 0; l < kLosses; ++l) ln_[r][l] += other.ln_[r][l];
  return *this;
}

DirectionLikelihood& DirectionLikelihood::operator-=(const DirectionLikelihood& other) {
  hits_ -= other.hits_;
  for (std::size_t r = 0; r < kRatios; ++r)
    for (std::size_t l = 0; l < kLosses; ++l) ln_[r][l] -= other.ln_[r][l];
  return *this;
}

double DirectionLikelihood::at(int ratio, bool wide) const {
  const auto& of_loss = ln_[static_cast<std::size_t>(ratio)];
  if (!wide) return of_loss[0];
  const auto best = static_cast<std::size_t>(std::max_element(of_loss.begin(), of_loss.end()) - of_loss.begin());
  if (best == 0 || best + 1 == of_loss.size()) return of_loss[best];
  const double step = vertex(of_loss[best - 1], of_loss[best], of_loss[best + 1]);
  return of_loss[best] + 0.25 * step * (of_loss[best + 1] - of_loss[best - 1]);
}

std::optional<double> DirectionLikelihood::ln_ratio(bool wide) const {
  std::array<double, kRatios> ln{};
  for (int r = 0; r < kRatios; ++r) ln[static_cast<std::size_t>(r)] = at(r, wide);
  const auto best = static_cast<int>(std::max_element(ln.begin(), ln.end()) - ln.begin());
  if (best == 0 || best + 1 == kRatios) return std::nullopt;
  const auto i = static_cast<std::size_t>(best);
  return ln_ratio_of(best) + kLnRatioStep * vertex(ln[i - 1], ln[i], ln[i + 1]);
}

LeafAngles LeafAngleFit::angles() const {
  const double flatter = ln_ratio - kSphericalLooks;
  if (!measured || flatter <= kSurelyFlatter) return {LeafAngleType::spherical, 1};
  const double share = std::min(1.0, (flatter - kSurelyFlatter) / (kCountsWhole - kSurelyFlatter));
  return {LeafAngleType::ellipsoidal, std::exp(share * flatter)};
}

LeafAngleFit fit_leaf_angles(std::span<const DirectionLikelihood> parts, bool wide) {
  DirectionLikelihood all;
  std::vector<const DirectionLikelihood*> used;
  for (const DirectionLikelihood& part : parts)
    if (part.hits() > 0) all += part, used.push_back(&part);
  LeafAngleFit fit;
  const std::optional<double> whole = all.ln_ratio(wide);
  if (!whole || all.hits() < kEnoughHits || used.size() < kEnoughParts) return fit;
  fit.ln_ratio = *whole;
  double sum = 0, squares = 0;
  for (const DirectionLikelihood* part : used) {
    DirectionLikelihood others = all;
    others -= *part;
    const std::optional<double> without = others.ln_ratio(wide);
    if (!without) return fit;
    sum += *without, squares += *without * *without;
  }
  const auto n = static_cast<double>(used.size());
  fit.error = std::sqrt(std::max(0.0, (n - 1) / n * (squares - sum * sum / n)));
  fit.measured = fit.error <= kLargestError;
  return fit;
}

}  // namespace rayfield::density
