#include "libdensity/echoes/echo_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libdensity/echoes/full_echoes.h"
#include "libdensity/echoes/leaf_normals.h"
#include "libdensity/echoes/unreturned_beams.h"
#include "libdensity/echoes/wood_echoes.h"

namespace rayfield::density {
namespace {

constexpr std::uint64_t kEnoughEchoes = 5000, kEnoughOfWood = 1000;
constexpr std::size_t kEnoughFull = 10;
// Leafiness from which on leaves are seen: where nothing ends behind hits, less for each end per metre there, up to as
// many as leaves make at least; and of that where the month, or the user, says that leaves are unlikely or likely.
// Where too few beams pass hits to tell, the ends that make it six.
constexpr double kLeastLeafiness = 8, kLessPerEndBehind = 9, kEndsBehindOfLeaves = 0.45;
constexpr double kEndsBehindNotKnown = (kLeastLeafiness - 6) / kLessPerEndBehind;
constexpr double kWhereUnlikely = 4.0 / 3, kWhereLikely = 0.5;
constexpr double kLeastOverWood = 0.55;  // of a full echo over that of wood: weaker ones are of canes
constexpr double kWoodInFullEcho = 0.5;  // relative error of the full echo, times leafiness: canes' echoes are weak
constexpr double kFullError = 0.04;      // relative, of the full echo from full echoes, beside what they tell of it
constexpr double kLackingError = 0.5;    // and of what they lack, as a share of it
// ln of a full echo over the mean one: without anything else; where leaves stand apart, and for each side of a leaf
// that beams are wide (both fading the more leaves make an echo together); for how it goes with the angle of incidence,
// per unit of cosine over a full echo; for each mean echo that the weakest reach; and for each unit of ln of the
// strengths that some shares of the echoes do not reach over the mean. Relative errors of what comes of it, beside wood
// among the leaves and of wood (over leafiness).
constexpr double kAboveMean = 0.47, kApartAboveMean = 0.04, kWidthAboveMean = 0.71, kFadesPerLeaf = 0.75;
constexpr double kAngleAboveMean = -0.05;
constexpr double kWeakestAboveMean = -0.54;
struct OfStrength {
  double share, per_unit;
};
constexpr std::array<OfStrength, 3> kStrengths{{{0.2, -0.43}, {0.4, -1.02}, {0.9, -1.24}}};
constexpr double kLeastAboveMean = 0, kMostAboveMean = 0.7;  // 0.06 to 0.52 on simulated scans
constexpr double kMeanEchoError = 0.04, kWoodInMeanEcho = 0.7;
// ln of a full echo over the strength that 98 % of the echoes do not reach, which pieces of canes do not change:
// without anything else, for each unit of ln of the strengths that 90 and 80 % do not reach over that, for how it goes
// with the angle of incidence, and for each side of a leaf that beams are wide. The mean echo stands for no less than
// so much of it.
constexpr double kBrightEchoes = 0.98, kAboveBright = -0.112, kBrightSlope = -0.16, kBrightWidth = 0.235;
constexpr std::array<OfStrength, 2> kBelowBright{{{0.9, 4.235}, {0.8, -1.748}}};
constexpr double kLeastOfBright = 0.9;
constexpr double kLacking = 1.8, kLackingPower = 2.5;  // of full echoes, by the beam's width over a leaf's side, at
constexpr double kLackingResolutionM = 0.15, kLackingShare = 0.3;  // b = 0 and t = 0; falls with either
constexpr double kMostLacking = 0.3;
constexpr double kCutOfFull = 0.32;  // scatter of full echoes by what edges cut off, by the beam's width over a side
constexpr double kUsualAngleDependence = 0.5, kUsualScatter = 0.15;
constexpr double kMostAngleDependence = 0.9;  // a blade is not so flat that it vanishes when seen edge-on
constexpr double kWeakestShare = 0.02;        // of the echoes lie below the detection share,
constexpr double kWeakest = 1.03;             // nearly: where they begin, in detection shares
constexpr double kOneBeamsBeside = 0.2;       // or more, of the echoes
// Of the apparent side of leaves, as ln of its ratio to the true one: narrow beams of a fine range resolution, what a
// beam of kSmearM adds and what a metre of range resolution takes away.
constexpr double kSmearM = 0.060, kUnmixed = 0.27, kSmear = 1.02, kMixedPerM = 3.03, kMostMixedM = 0.4;
// Of lidars with several beams at a time, whose rays are farther from each other: full echoes, of which weaker ones are
// not taken for one of a leaf's, the depths and the distances that are looked at, and how much too large a side looks.
constexpr double kSeveralBeamsOfLeaf = 0.5, kSeveralBeamsWindowM = 0.08, kSeveralBeamsFarthestM = 0.06;
constexpr double kSeveralBeamsSmear = 1.12;
constexpr double kWeakestFullEcho = 0.5;  // of leaves turned somehow, over that of leaves turned at random
constexpr int kRounds = 4;                // full echo, detection share and size of leaves depend on each other

using Bins = std::array<EchoStatistics::Sum, EchoStatistics::kWidthBins>;

double width_of(int bin) { return (bin + 0.5) * EchoStatistics::kWidthStepM; }

/// Mean width of the beams of some bins.
double mean_width(const Bins& bins) {
  double n = 0, sum = 0;
  for (int b = 0; b < EchoStatistics::kWidthBins; ++b) {
    const auto count = static_cast<double>(bins[static_cast<std::size_t>(b)].count);
    n += count, sum += count * width_of(b);
  }
  return n > 0 ? sum / n : 0;
}

EchoStatistics::Sum sum_of(const Bins& bins) {
  EchoStatistics::Sum sum;
  for (const auto& bin : bins) sum.add(bin.count, bin.intensity);
  return sum;
}

double variation_of(const std::vector<std::uint32_t>& histogram) {
  double n = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    const double count = histogram[i], intensity = static_cast<double>(i);
    n += count, sum += count * intensity, squares += count * intensity * intensity;
  }
  return sum > 0 ? n * squares / (sum * sum) - 1 : 0;
}

void measure_leaves(const EchoStatistics& statistics, const EchoKnowledge& known, EchoModel& model) {
  if (known.leaf_size_m2 >= 0) {
    model.leaf_size_m2 = known.leaf_size_m2, model.leaf_size_from = LeafSizeFrom::options;
    return;
  }
  const bool one_beam = sends_one_beam(statistics);
  const LeafSizePairs pairs = statistics.pairs_from(one_beam ? 0 : model.full_echo * kSeveralBeamsOfLeaf);
  // Of one lidar's beam ranges that scatter are means of several leaves, which b tells: the usual windows.
  PairWindows windows = kUsualWindows;
  if (!one_beam)
    windows = {kSeveralBeamsWindowM, std::max(kUsualWindows.range_noise_m, range_noise_of(pairs)),
               kSeveralBeamsFarthestM};
  const LeafSize apparent = estimate_leaf_size(counts_of(pairs, windows.window_m), windows);
  const double widths = model.mean_width_m / kSmearM, resolution_m = std::min(kMostMixedM, model.range_resolution_m);
  const double smear = one_beam ? std::exp(kUnmixed + kSmear * widths - kMixedPerM * resolution_m) : kSeveralBeamsSmear;
  model.leaf_size_from = apparent.measured ? LeafSizeFrom::pairs : LeafSizeFrom::nothing;
  model.leaf_size_m2 = apparent.measured ? apparent.area_m2 / (smear * smear) : apparent.area_m2;
}

/// Of what leaves take of the beams, the share that is in no echo, being in pieces below the detection share t: edges
/// are cut alike on both sides of it, so that with f the number of echoes per unit of strength between t and t + 0.1 it
/// is 1.2·f·t²/2 (docs/beams.md, "How it is taken out"). Whole numbers of intensity stand for a unit: the band holds
/// few of them where a lidar counts full echoes in tens.
double lost_share(const std::vector<std::uint32_t>& histogram, double full_echo, double detection_share) {
  const double from = detection_share * full_echo, to = (detection_share + kBandAboveWeakest) * full_echo;
  double strength = 0, in_band = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    const auto intensity = static_cast<double>(i);
    strength += histogram[i] * intensity / full_echo;
    in_band += histogram[i] * std::max(0.0, std::min(intensity + 0.5, to) - std::max(intensity - 0.5, from));
  }
  const double lost = kPiecesBelow * in_band / kBandAboveWeakest * detection_share * detection_share / 2;
  return strength > 0 ? lost / (strength + lost) : 0;
}

/// Echoes over those of beams that fall wholly on posts and trunks: 1–5 for bare vines, 20–50 at full leaf.
double leafiness_of(const EchoStatistics& statistics) {
  return static_cast<double>(statistics.echoes()) /
         static_cast<double>(std::max<std::int64_t>(1, statistics.wood().count));
}

bool shows_leaves(const EchoStatistics& statistics, Foliage foliage) {
  const double behind = ends_per_metre_behind(statistics.pairs_from(0), kEndsBehindNotKnown);
  const double least = kLeastLeafiness - kLessPerEndBehind * std::min(kEndsBehindOfLeaves, behind);
  switch (foliage) {
    case Foliage::none:
      return false;
    case Foliage::unlikely:
      return leafiness_of(statistics) >= kWhereUnlikely * least;
    case Foliage::likely:
      return leafiness_of(statistics) >= kWhereLikely * least;
    case Foliage::unknown:
      break;
  }
  return leafiness_of(statistics) >= least;
}

double widths_of_leaf(const EchoModel& model) {
  return model.leaf_size_m2 > 0 ? model.mean_width_m / std::sqrt(model.leaf_size_m2) : 0;
}

/// What is missing of full echoes in the mean: where beams are as wide as leaves few fall wholly on one, and of those
/// that look as if they did, part went past. The coarser the range resolution and the higher the detection share, the
/// more of the echoes around a full one are themselves nearly full (docs/beams.md, "How it is taken out").
double lacking_of(const EchoModel& model) {
  const double widths = widths_of_leaf(model);
  const double apart =
      std::exp(-model.range_resolution_m / kLackingResolutionM - model.detection_share / kLackingShare);
  return std::min(kMostLacking, kLacking * std::pow(widths, kLackingPower) * apart);
}

/// A strength and its relative error.
struct Strength {
  double intensity = 0, error = 0;
  double weight() const { return 1 / (error * error); }
};

/// Of two that should be alike: what they differ by, in standard errors of that.
double disagreement(const Strength& one, const Strength& other) {
  return std::abs(std::log(one.intensity / other.intensity)) / std::hypot(one.error, other.error);
}

/// What the beams' width makes of ln of a full echo over the mean one.
double width_above_mean(const EchoModel& model) {
  const double apart = std::exp(-kFadesPerLeaf * model.leaves_per_resolution);
  return apart * (kApartAboveMean + kWidthAboveMean * widths_of_leaf(model));
}

/// What the brightest echoes say of a full one, where leaves are so few that most echoes are of pieces of canes.
double from_bright_echoes(const EchoStatistics& statistics, const FullEchoStrength& full, const EchoModel& model) {
  const double bright = std::max(1.0, strength_quantile(statistics.histogram(), kBrightEchoes));
  double above = kAboveBright + kBrightSlope * full.slope + kBrightWidth * widths_of_leaf(model);
  for (const auto& [share, per_unit] : kBelowBright)
    above += per_unit * std::log(std::max(1.0, strength_quantile(statistics.histogram(), share)) / bright);
  return bright * std::exp(above);
}

/// The full echo that the mean of all echoes stands for (docs/beams.md, "How it is taken out"): how strengths are
/// spread about it tells how many are of pieces.
Strength from_mean_echo(const EchoStatistics& statistics, double weakest, const FullEchoStrength& full,
                        const EchoModel& model) {
  const double mean = sum_of(statistics.all()).mean(), wood = 1 / leafiness_of(statistics);
  double above =
      kAboveMean + width_above_mean(model) + kAngleAboveMean * full.slope + kWeakestAboveMean * weakest / mean;
  for (const auto& [share, per_unit] : kStrengths)
    above += per_unit * std::log(std::max(1.0, strength_quantile(statistics.histogram(), share)) / mean);
  const double error = std::hypot(kMeanEchoError, kAngleAboveMean * full.slope_error, kWoodInMeanEcho * wood);
  const double by_mean = mean * std::exp(std::clamp(above, kLeastAboveMean, kMostAboveMean));
  return {std::max(by_mean, kLeastOfBright * from_bright_echoes(statistics, full, model)), error};
}

/// How differently bright the leaves are: as full echoes say, where there are enough, less what edges cut off those.
LeafBrightness brightness_of(const FullEchoStrength& full, const EchoModel& model) {
  if (full.count < kEnoughFull) return {kUsualAngleDependence, kUsualScatter};
  const double cut = kCutOfFull * widths_of_leaf(model);
  return {std::min(kMostAngleDependence, full.angle_dependence),
          std::sqrt(std::max(0.0, full.scatter * full.scatter - cut * cut))};
}

/// From the mean echo, and from full echoes where there are enough, weighted by their errors; what comes of it is known
/// the less well the less they agree (their error grows with what they differ by, as that of averages is scaled by the
/// Particle Data Group).
void measure_full_echo(const EchoStatistics& statistics, const FullEchoStrength& full, const Strength& of_mean,
                       EchoModel& model) {
  model.full_echo = of_mean.intensity, model.full_echo_error = of_mean.error;
  model.mean_echo_weight = 1;
  if (full.count >= kEnoughFull && full.intensity > 0) {
    model.lacking_share = lacking_of(model);
    const Strength of_full{full.intensity / (1 - model.lacking_share),
                           std::hypot(kFullError, full.error, kLackingError * model.lacking_share)};
    const double weights = of_full.weight() + of_mean.weight();
    model.full_echo = (of_full.weight() * of_full.intensity + of_mean.weight() * of_mean.intensity) / weights;
    model.full_echo_error = std::max(1.0, disagreement(of_full, of_mean)) / std::sqrt(weights);
    model.mean_echo_weight = of_mean.weight() / weights;
    model.full_echo_per_cosine = of_full.weight() / weights * full.per_cosine;
  }
  model.full_echo_error = std::hypot(model.full_echo_error, kWoodInFullEcho / leafiness_of(statistics));
}

EchoModel model_of_leaves(const EchoStatistics& statistics, const EchoKnowledge& known, EchoModel model) {
  model.leaves_per_resolution = known.range_resolution_m * ends_per_metre_behind(statistics.pairs_from(0));
  model.full_echo = known.full_echo > 0 ? known.full_echo : sum_of(statistics.all()).mean();
  const double weakest = strength_quantile(statistics.histogram(), kWeakestShare), detected = weakest / kWeakest;
  const FullEchoStrength full = full_echo_strength(statistics.full(), statistics.ground_dependence());
  model.angle_slope = full.slope;
  for (int round = 0; round < kRounds; ++round) {
    model.detection_share = known.beam.detection_share.value_or(std::min(1.0, detected / model.full_echo));
    measure_leaves(statistics, known, model);
    if (known.full_echo > 0) break;
    measure_full_echo(statistics, full, from_mean_echo(statistics, weakest, full, model), model);
  }
  model.leaf_normals = fit_leaf_normals(statistics.full());
  model.wood_brightness = wood_brightness(statistics, model.full_echo).value, model.wood_per_side = known.wood_per_side;
  model.wood_error = known.wood_per_side > 0 ? wood_error(statistics, model.full_echo) : 0;
  model.lost_share = lost_share(statistics.histogram(), model.full_echo, model.detection_share);
  model.unreturned_share =
      model.lost_share * unreturned_per_lost(brightness_of(full, model), model.detection_share, widths_of_leaf(model));
  return model;
}

std::optional<EchoModel> model_of_wood(const EchoStatistics& statistics, const EchoKnowledge& known, EchoModel model) {
  const double weakest = strength_quantile(statistics.histogram(), kWeakestShare) / kWeakest;
  const auto wood = wood_echoes(statistics, sum_of(statistics.all()).mean(), weakest);
  if (!wood) return std::nullopt;
  model.full_echo = known.full_echo > 0 ? known.full_echo : wood->full_echo;
  model.full_echo_error = wood->error;
  model.detection_share = known.beam.detection_share.value_or(std::min(1.0, weakest / model.full_echo));
  model.wood_returned = wood->returned_share;
  model.leaf_size_from = known.leaf_size_m2 >= 0 ? LeafSizeFrom::options : LeafSizeFrom::pairs;
  model.leaf_size_m2 =
      known.leaf_size_m2 >= 0 ? known.leaf_size_m2 : estimate_leaf_size(statistics.pairs_from(0)).area_m2;
  return model;
}

}  // namespace

EchoModel with_aspect(EchoModel model, const LeafAspect& aspect) {
  const double before = model.full_echo, width_before = width_above_mean(model), lacking_before = model.lacking_share;
  if (model.leaf_size_from == LeafSizeFrom::pairs) model.leaf_size_m2 /= aspect.apparent_side * aspect.apparent_side;
  if (lacking_before > 0) model.lacking_share = lacking_of(model);
  const double of_full = (1 - lacking_before) / (1 - model.lacking_share);
  const double of_mean = std::exp(width_above_mean(model) - width_before);
  model.full_echo *= of_full + model.mean_echo_weight * (of_mean - of_full);
  model.full_echo += model.full_echo_per_cosine * (aspect.mean_cosine - kSphericalMeanCosine);
  model.full_echo = std::max(kWeakestFullEcho * before, model.full_echo);
  model.wood_brightness *= before / model.full_echo;
  if (!model.beam.detection_share)
    model.detection_share = std::min(1.0, model.detection_share * before / model.full_echo);
  return model;
}

EchoModel with_wood_as_leaves(EchoModel model) {
  model.wood_per_side = 0;
  return model;
}

bool sends_one_beam(const EchoStatistics& statistics) {
  return static_cast<double>(statistics.same_beam_beside()) >
         kOneBeamsBeside * static_cast<double>(statistics.echoes());
}

std::optional<EchoModel> estimate_echo_model(const EchoStatistics& statistics, const EchoKnowledge& known) {
  if (statistics.echoes() < kEnoughOfWood) return std::nullopt;
  EchoModel model{known.beam, known.range_resolution_m};
  model.echo_variation = variation_of(statistics.histogram());
  if (!(model.echo_variation > 1e-4)) return std::nullopt;  // a lidar that tells no intensity
  model.mean_width_m = mean_width(statistics.all());
  if (!shows_leaves(statistics, known.foliage)) return model_of_wood(statistics, known, model);
  if (statistics.echoes() < kEnoughEchoes) return std::nullopt;
  const EchoModel of_leaves = model_of_leaves(statistics, known, model);
  const bool may_be_canes = known.full_echo <= 0 && known.foliage != Foliage::likely;
  const bool of_canes = may_be_canes && of_leaves.full_echo < kLeastOverWood * statistics.wood().mean();
  return of_canes ? model_of_wood(statistics, known, model) : of_leaves;
}

}  // namespace rayfield::density
