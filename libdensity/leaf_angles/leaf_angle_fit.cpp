#include "libdensity/leaf_angles/leaf_angle_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libdensity/echoes/leaf_angle.h"
#include "libdensity/echoes/leaf_size.h"

namespace rayfield::density {
namespace {

using ByRatio = Eigen::Array<double, DirectionLikelihood::kRatios, 1>;

constexpr double kEnoughHits = 5000;
constexpr std::size_t kEnoughParts = 4;
constexpr double kLargestError = 0.3;
// Of ln of the ratio, beside sampling: by directions with the usual leverage, how far sites with spherical leaves
// differ, through wide beams the more the more is lost, since level beams lose more than steep ones; by normals.
constexpr double kDirectionsError = 0.15, kDirectionsErrorWide = 0.25, kDirectionsErrorPerLost = 4;
constexpr double kNormalsError = 0.15;
// In standard errors: up to the first, leaves are taken for spherical, from the second on the ratio counts as it is
// found.
constexpr double kSurelyFlatter = 2, kCountsWhole = 3;
// Up to this error of ln ratio flat leaves are told from others. Where they are not: how far ln ratio may be from that
// of leaves turned at random beforehand (the belief of leaf_normals.h, too), and how far directions of planophile
// leaves differ between sites, which is more than those of leaves turned at random do.
constexpr double kTellingError = 0.25, kBeliefError = 0.7, kFlatDirectionsError = 0.38;
// Of ln of the area for each unit of ln ratio: planophile leaves that were taken for spherical read 0.36 to 0.70 too
// small by it, the full echo being too strong for them besides.
constexpr double kAreaPerLnRatio = 0.6;

double ln_ratio_of(int i) { return DirectionLikelihood::kFirstLnRatio + i * DirectionLikelihood::kLnRatioStep; }

/// What a unit of path meets, up to a factor: the product of `projection` for its steepness, by ratio, and `returned`
/// for its range, by loss.
struct Meetings {
  std::array<ByRatio, DirectionCounters::kSteepness> projection;
  std::array<std::array<double, DirectionCounters::kRanges>, DirectionLikelihood::kLosses> returned;
};

Meetings make_meetings() {
  Meetings out{};
  for (std::size_t k = 0; k < DirectionCounters::kSteepness; ++k)
    for (int r = 0; r < DirectionLikelihood::kRatios; ++r)
      out.projection[k](r) =
          leaf_projection({LeafAngleType::ellipsoidal, std::exp(ln_ratio_of(r))}, DirectionCounters::kSine[k]);
  for (int l = 0; l < DirectionLikelihood::kLosses; ++l)
    for (std::size_t d = 0; d < DirectionCounters::kRanges; ++d)
      out.returned[static_cast<std::size_t>(l)][d] =
          std::exp(-l * DirectionLikelihood::kLossStepPerM * DirectionCounters::kRange_m[d]);
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

std::array<ByRatio, DirectionLikelihood::kLosses> DirectionLikelihood::zeros() {
  std::array<ByRatio, kLosses> out;
  out.fill(ByRatio::Zero());
  return out;
}

void DirectionLikelihood::add(const DirectionCounters& voxel) {
  const Meetings& m = meetings();
  std::int64_t hits = 0;
  int bins = 0;
  std::array<ByRatio, DirectionCounters::kRanges> met;  // without loss
  std::array<std::size_t, DirectionCounters::kRanges> ranges{};
  std::size_t range_count = 0;
  for (std::size_t d = 0; d < DirectionCounters::kRanges; ++d) {
    ByRatio sum = ByRatio::Zero();
    const int before = bins;
    for (std::size_t k = 0; k < DirectionCounters::kSteepness; ++k) {
      const std::size_t bin = d * DirectionCounters::kSteepness + k;
      if (voxel.path[bin] <= 0) continue;
      sum += DirectionCounters::kPathUnit * static_cast<double>(voxel.path[bin]) * m.projection[k];
      hits += voxel.hits[bin], ++bins;
    }
    if (bins > before) met[d] = sum, ranges[range_count++] = d;
  }
  if (hits <= 0 || bins < 2) return;
  const double unit = 1 / full_echo_.value_or(1);
  for (std::size_t i = 0; i < DirectionCounters::kBins; ++i)
    if (voxel.path[i] > 0) hits_[i] += unit * static_cast<double>(voxel.hits[i]);
  for (std::size_t l = 0; l < static_cast<std::size_t>(losses()); ++l) {
    ByRatio sum = ByRatio::Zero();
    for (std::size_t n = 0; n < range_count; ++n) sum += m.returned[l][ranges[n]] * met[ranges[n]];
    hits_ln_met_[l] += unit * static_cast<double>(hits) * sum.log();
  }
}

DirectionLikelihood& DirectionLikelihood::operator+=(const DirectionLikelihood& other) {
  for (std::size_t i = 0; i < hits_.size(); ++i) hits_[i] += other.hits_[i];
  for (std::size_t l = 0; l < kLosses; ++l) hits_ln_met_[l] += other.hits_ln_met_[l];
  return *this;
}

DirectionLikelihood& DirectionLikelihood::operator-=(const DirectionLikelihood& other) {
  for (std::size_t i = 0; i < hits_.size(); ++i) hits_[i] -= other.hits_[i];
  for (std::size_t l = 0; l < kLosses; ++l) hits_ln_met_[l] -= other.hits_ln_met_[l];
  return *this;
}

double DirectionLikelihood::hits() const { return std::accumulate(hits_.begin(), hits_.end(), 0.0); }

std::array<double, DirectionCounters::kSteepness> DirectionLikelihood::hits_by_steepness() const {
  std::array<double, DirectionCounters::kSteepness> out{};
  for (std::size_t i = 0; i < hits_.size(); ++i) out[i % DirectionCounters::kSteepness] += hits_[i];
  return out;
}

double DirectionLikelihood::at(int ratio) const {
  const Meetings& m = meetings();
  std::array<double, kLosses> ln{};
  for (std::size_t l = 0; l < static_cast<std::size_t>(losses()); ++l) {
    ln[l] = -hits_ln_met_[l](ratio);
    for (std::size_t i = 0; i < hits_.size(); ++i)
      ln[l] += hits_[i] * std::log(m.projection[i % DirectionCounters::kSteepness](ratio) *
                                   m.returned[l][i / DirectionCounters::kSteepness]);
  }
  if (!full_echo_) return ln[0];
  const auto best = static_cast<std::size_t>(std::max_element(ln.begin(), ln.end()) - ln.begin());
  if (best == 0 || best + 1 == ln.size()) return ln[best];
  const double step = vertex(ln[best - 1], ln[best], ln[best + 1]);
  return ln[best] + 0.25 * step * (ln[best + 1] - ln[best - 1]);
}

std::optional<double> DirectionLikelihood::ln_ratio() const {
  std::array<double, kRatios> ln{};
  for (int r = 0; r < kRatios; ++r) ln[static_cast<std::size_t>(r)] = at(r);
  const auto best = static_cast<int>(std::max_element(ln.begin(), ln.end()) - ln.begin());
  if (best == 0 || best + 1 == kRatios) return std::nullopt;
  const auto i = static_cast<std::size_t>(best);
  return ln_ratio_of(best) + kLnRatioStep * vertex(ln[i - 1], ln[i], ln[i + 1]);
}

std::optional<LnRatio> LeafAngleFit::by_directions() const {
  if (!measured) return std::nullopt;
  const double unsure = std::max(1.0, kUsualLeverage / leverage);
  const double of_site =
      wide_beams ? std::hypot(kDirectionsErrorWide, kDirectionsErrorPerLost * lost_share) : kDirectionsError;
  return LnRatio{ln_ratio - spherical_looks, std::hypot(error, unsure * of_site)};
}

std::optional<LnRatio> LeafAngleFit::by_normals() const {
  if (!normals) return std::nullopt;
  return LnRatio{normals->value, std::hypot(normals->error, kNormalsError)};
}

std::optional<LnRatio> LeafAngleFit::flatter() const {
  const std::optional<LnRatio> directions = by_directions(), full = by_normals();
  if (!directions || !full) return full ? full : directions;
  const double weights = full->weight() + directions->weight();
  return LnRatio{(full->weight() * full->value + directions->weight() * directions->value) / weights,
                 1 / std::sqrt(weights)};
}

double LeafAngleFit::disagreement() const {
  const std::optional<LnRatio> directions = by_directions(), full = by_normals();
  if (!directions || !full) return 1;
  return std::max(1.0, std::abs(full->value - directions->value) / std::hypot(full->error, directions->error));
}

LeafAngles LeafAngleFit::angles() const {
  const std::optional<LnRatio> found = flatter();
  if (!found || !(found->value > kSurelyFlatter * found->error)) return {LeafAngleType::spherical, 1};
  const double share = std::min(1.0, (found->value / found->error - kSurelyFlatter) / (kCountsWhole - kSurelyFlatter));
  return {LeafAngleType::ellipsoidal, std::exp(share * found->value)};
}

bool LeafAngleFit::tells() const {
  const std::optional<LnRatio> found = flatter();
  return given || !wide_beams || (found && found->error <= kTellingError);
}

double LeafAngleFit::area_error() const {
  const std::optional<LnRatio> found = flatter();
  if (!found) return tells() ? 0 : kAreaPerLnRatio * kBeliefError;
  const LeafAngles taken = angles();
  if (taken.type != LeafAngleType::spherical)
    return kAreaPerLnRatio * std::hypot(found->value - std::log(taken.ellipsoid_ratio), disagreement() * found->error);
  if (!tells())
    return kAreaPerLnRatio * std::min(kBeliefError, std::hypot(std::max(0.0, found->value),
                                                               std::max(kFlatDirectionsError, found->error)));
  return kAreaPerLnRatio * std::max(0.0, found->value - found->error);  // leaves turned at random look as flat as that
}

namespace {

/// Errors from how the parts differ (jackknife).
LeafAngleFit fit_ratio(std::span<const DirectionLikelihood* const> parts, const DirectionLikelihood& all) {
  LeafAngleFit fit;
  const std::optional<double> whole = all.ln_ratio();
  if (!whole || all.hits() < kEnoughHits || parts.size() < kEnoughParts) return fit;
  fit.ln_ratio = *whole;
  double sum = 0, squares = 0;
  for (const DirectionLikelihood* part : parts) {
    DirectionLikelihood others = all;
    others -= *part;
    const std::optional<double> without = others.ln_ratio();
    if (!without) return fit;
    sum += *without, squares += *without * *without;
  }
  const auto n = static_cast<double>(parts.size());
  fit.error = std::sqrt(std::max(0.0, (n - 1) / n * (squares - sum * sum / n)));
  fit.measured = fit.error <= kLargestError;
  return fit;
}

double leverage_of(const DirectionLikelihood& all) {
  constexpr double kLnRatio = 0.4;
  const auto hits = all.hits_by_steepness();
  double n = 0, sum = 0, squares = 0;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const double sine = DirectionCounters::kSine[k];
    const double flat = leaf_projection({LeafAngleType::ellipsoidal, std::exp(kLnRatio)}, sine);
    const double change = std::log(flat / leaf_projection({LeafAngleType::spherical, 1}, sine)) / kLnRatio;
    n += hits[k], sum += hits[k] * change, squares += hits[k] * change * change;
  }
  return n > 0 ? std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))) : 0;
}

LeafAspect aspect_of(const LeafAngles& angles, const DirectionLikelihood& all) {
  const auto hits = all.hits_by_steepness();
  double cosines = 0, sum = 0;
  for (std::size_t k = 0; k < hits.size(); ++k)
    cosines += hits[k] * mean_incidence_cosine(angles, DirectionCounters::kSine[k]), sum += hits[k];
  return {cosines / sum, apparent_side(angles, DirectionCounters::kSine, hits)};
}

}  // namespace

LeafAngleFit fit_leaf_angles(std::span<const DirectionLikelihood> parts, const LeafAngles& angles,
                             const std::optional<LnRatio>& normals, double lost_share) {
  std::vector<const DirectionLikelihood*> used;
  for (const DirectionLikelihood& part : parts)
    if (part.hits() > 0) used.push_back(&part);
  if (used.empty()) return {};
  DirectionLikelihood all = *used.front();
  for (std::size_t i = 1; i < used.size(); ++i) all += *used[i];
  const bool measures = angles.type == LeafAngleType::measured;
  LeafAngleFit fit = measures ? fit_ratio(used, all) : LeafAngleFit{};
  if (measures) fit.normals = normals;
  fit.given = !measures;
  fit.wide_beams = all.of_wide_beams(), fit.lost_share = lost_share;
  fit.spherical_looks = fit.wide_beams ? kSphericalLooksWide : kSphericalLooks;
  fit.leverage = leverage_of(all);
  const LeafAngles taken = angles.type == LeafAngleType::measured ? fit.angles() : angles;
  fit.aspect = aspect_of(taken, all);
  return fit;
}

}  // namespace rayfield::density
