#include "libdensity/estimate/voxel_sums.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rayfield::density {
namespace {

constexpr int kRounds = 3;
// What keeps beams from returning what thin rays would, as parts of −ln R (docs/beams.md, "How it is taken out"):
// times the unreturned share and the optical path across the row, less where a coarse range resolution adds up leaves,
constexpr double kUnreturnedAcross = 1.2, kFadesFromM = 0.17, kFadesM = 0.25;
// times the lost share and that path (kMostLostAcross at most: hardly a scan of the fit has more), and the lost share
// over that path, for wood, but no more than all of it, and
constexpr double kLostAcross = 0.26, kMostLostAcross = 0.2, kLostOfWood = 0.45;
// the beam's width over a leaf's side, less where leaves of a range resolution add up;
constexpr double kCutByEdges = 0.10, kAddedUp = 1.5;
// of lidars that report one echo of several and not the first, what the others took: times the root of the width over a
// side and of the path across, fading with the range resolution. An echo may hide a stronger one up to half of the
// beam, since what is left of it has to be stronger: times how far t is below half. A later echo takes the place of one
// between t and 1 − t, and is the likelier the lower t: times the square of that.
constexpr double kBeforeStronger = 1.1, kBeforeLast = 11, kHalfOfBeam = 0.5;
constexpr double kLeastReturned = 0.3, kMostReturned = 1.2;
constexpr double kWoodProjection = 0.5, kMostWood = 0.8;  // of half its surface, turned at random; of the optical path
constexpr double kThicknessReachM = 1.5;                  // along the row
constexpr double kLeastPath = 0.1;  // of the path up to the echoes; echoes above a full one count as passed less behind

/// The path of a voxel's beams, those parts of them that ran on behind their echoes included.
double path_of(const VoxelCounters& v, const EchoCounters& e, double full_echo) {
  const auto behind = static_cast<double>(e.behind), taken = static_cast<double>(e.echo_behind) / full_echo;
  return std::max(kLeastPath * v.path_sides(), v.path_sides() + EchoCounters::kPathUnit * (behind - taken));
}

/// Mean width of a voxel's beams, by path.
std::optional<double> width_of(const VoxelCounters& v, const EchoCounters& e) {
  const double units = v.path_sides() / EchoCounters::kPathUnit;
  if (!(units > 0)) return std::nullopt;
  return EchoCounters::kWidthUnitM * static_cast<double>(e.width) / units;
}

/// What echoes mean at a place.
struct EchoesThere {
  double returned = 1;    ///< R
  double brightness = 1;  ///< of what stands there, leaves and wood, beside that of leaves
};

VoxelSums wide_beam_sum(const VoxelCounters& v, const EchoCounters& e, const EchoesThere& there,
                        const EchoModel& model) {
  const double full_echo = there.brightness * model.full_echo;
  const double share = v.hits > 0 ? static_cast<double>(e.echo) / (full_echo * v.hits) : 0;
  VoxelSums s;
  s.rays = v.rays, s.ends = v.hits;
  s.hits = v.hits * share;
  s.hits_squared = v.hits * share * share * (1 + model.echo_variation);
  s.path = there.returned * path_of(v, e, model.full_echo);
  s.hit_path = there.returned * share * v.hit_path_sides();
  s.potential = v.potential_sides();
  return s;
}

/// A row at one of its cross sections, as its hits see it.
struct RowThere {
  double thickness = 0;         ///< optical path of a ray right across it, in the mean over the heights of the hits
  double density_per_side = 0;  ///< optical path per voxel side, in the mean over the hits
};

/// Hits and paths of neighbouring cross sections of a row, added up.
class SectionSum {
 public:
  explicit SectionSum(const CrossSection& section)
      : section_(section), hits_(section.voxels()), path_(section.voxels()) {}
  void add(std::span<const VoxelSums> section, double sign) {
    for (std::size_t k = 0; k < section.size(); ++k)
      hits_[k] += sign * section[k].hits, path_[k] += sign * section[k].path;
  }
  RowThere there() const {
    constexpr double kLeastSum = 1;  // voxel sides
    double across_row = 0, density = 0, all = 0;
    for (std::size_t up = 0; up < section_.n_up; ++up) {
      double across = 0, hits = 0;
      for (std::size_t k = up; k < section_.voxels(); k += section_.n_up) {
        const double rate = path_[k] > kLeastSum ? hits_[k] / path_[k] : 0;
        across += rate, density += hits_[k] * rate, hits += hits_[k];
      }
      across_row += hits * across, all += hits;
    }
    return all > 0 ? RowThere{across_row / all, density / all} : RowThere{};
  }

 private:
  CrossSection section_;
  std::vector<double> hits_, path_;
};

/// The row at each cross section: of all up to kThicknessReachM from it.
std::vector<RowThere> row_along(std::span<const VoxelSums> sums, const CrossSection& section) {
  const std::size_t count = section.voxels() > 0 ? sums.size() / section.voxels() : 0;
  const auto reach = static_cast<std::size_t>(kThicknessReachM / section.voxel_m);
  const auto at = [&](std::size_t along) { return sums.subspan(along * section.voxels(), section.voxels()); };
  std::vector<RowThere> out(count);
  SectionSum near(section);
  for (std::size_t along = 0; along < std::min(reach, count); ++along) near.add(at(along), 1);
  for (std::size_t along = 0; along < count; ++along) {
    if (along + reach < count) near.add(at(along + reach), 1);
    if (along > reach) near.add(at(along - reach - 1), -1);
    out[along] = near.there();
  }
  return out;
}

/// What echoes mean at every voxel of a row, from what the round before says of its density.
class EchoesOfRow {
 public:
  EchoesOfRow(const EchoModel& model, const CrossSection& section) : model_(model), section_(section) {}
  EchoesThere at(std::size_t voxel, std::optional<double> width_m) const {
    if (model_.wood_returned) return {width_m ? *model_.wood_returned : 1, 1};
    const RowThere row = row_.empty() ? RowThere{} : row_[voxel / section_.voxels()];
    return {width_m ? returned(row, *width_m) : 1, brightness(row.thickness)};
  }

  void learn(std::span<const VoxelSums> sums) { row_ = row_along(sums, section_); }

 private:
  double returned(const RowThere& row, double width_m) const {
    const double widths = model_.leaf_size_m2 > 0 ? width_m / std::sqrt(model_.leaf_size_m2) : 0;
    const double together = row.density_per_side * model_.range_resolution_m / section_.voxel_m;
    const double added_up_m = std::max(0.0, model_.range_resolution_m - kFadesFromM);
    const double unreturned = model_.unreturned_share * row.thickness * std::exp(-added_up_m / kFadesM);
    const double lost_across = std::min(kMostLostAcross, model_.lost_share * row.thickness);
    const double of_wood = row.thickness > 0 ? model_.lost_share * std::min(1.0, kLostOfWood / row.thickness) : 0;
    const double missing = kUnreturnedAcross * unreturned + kLostAcross * lost_across + of_wood +
                           kCutByEdges * widths * (1 - kAddedUp * together) + in_other_echoes(widths, row.thickness);
    return std::clamp(std::exp(-missing), kLeastReturned, kMostReturned);
  }

  /// Of what stands there beside that of leaves: of the optical path across wood has as much as it has of itself.
  double brightness(double thickness) const {
    const double of_wood = thickness > 0 ? kWoodProjection * model_.wood_per_side / thickness : 0;
    return 1 - std::min(kMostWood, of_wood) * (1 - model_.wood_brightness);
  }

  /// −ln of what is left of the path for what echoes took that the lidar does not report.
  double in_other_echoes(double widths, double thickness) const {
    const double below_half = std::max(0.0, kHalfOfBeam - model_.detection_share);
    double taken = 0;
    if (model_.beam.returns == ReturnMode::strongest) taken = kBeforeStronger * below_half;
    if (model_.beam.returns == ReturnMode::last) taken = kBeforeLast * below_half * below_half;
    return taken * std::sqrt(widths * thickness) * std::exp(-model_.range_resolution_m / kFadesM);
  }

  const EchoModel& model_;
  CrossSection section_;
  std::vector<RowThere> row_;  // [along]
};

}  // namespace

std::vector<VoxelSums> thin_ray_sums(std::span<const VoxelCounters> counters) {
  std::vector<VoxelSums> sums;
  sums.reserve(counters.size());
  for (const VoxelCounters& v : counters) {
    const double hits = v.hits;
    sums.push_back({v.rays, v.hits, hits, hits, v.path_sides(), v.hit_path_sides(), v.potential_sides()});
  }
  return sums;
}

std::vector<VoxelSums> wide_beam_sums(std::span<const VoxelCounters> counters, std::span<const EchoCounters> echoes,
                                      const CrossSection& section, const EchoModel& model) {
  std::vector<VoxelSums> sums(counters.size());
  EchoesOfRow row(model, section);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < counters.size(); ++i) {
      if (counters[i].rays == 0) continue;
      const EchoesThere there = row.at(i, width_of(counters[i], echoes[i]));
      sums[i] = wide_beam_sum(counters[i], echoes[i], there, model);
    }
    if (round + 1 < kRounds) row.learn(sums);
  }
  return sums;
}

}  // namespace rayfield::density
