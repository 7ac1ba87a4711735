#include "libdensity/scan/scan_echoes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libdensity/echoes/echo_model_arrays.h"
#include "libdensity/scan/echo_sample.h"
#include "libdensity/scan/scan_range_resolution.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/season/vine_year.h"
#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

constexpr double kTypicalRangeM = 2;  // from a lane to the row beside it
constexpr double kThinM = 0.003;      // diameter there
// Error of the logarithm where echoes are counted as hits, by the diameter there: canes are a few millimetres thick.
// Beams of low detection shares find twice of them, those of high shares a half to a third (docs/beams.md, "How far it
// can be trusted").
constexpr double kCountedErrorPerM = 40, kMostCountedError = 0.65;
// Of the logarithm where echoes are weighed (docs/beams.md, "How far it can be trusted"): of the law itself; for each
// part of what leaves take that is in no echo, which the law makes up for, chosen with 103 scans in view; and for each
// part that the full echo is off, measured on 82 of them: the more, the more leaves stand in a range resolution. The
// law was fitted with full echoes as they are found, so that errors of the two cancel in part: areas are off by less
// than that makes together, for which a factor stands. Where echoes go with the angle they are off by more, by the
// square of the slope with the cosine. Both of these chosen with 165 scans drawn at random.
constexpr double kLawError = 0.02, kErrorOfLost = 0.9, kErrorOfFullEcho = 0.8, kErrorPerLeaf = 1.4;
constexpr double kTogether = 0.6, kErrorOfAngle = 0.05;
// Wide beams come back from the ground only where it is met steeply. In a cloud without the others leaves seem to stop
// more rays than they do (docs/beams.md, "How far it can be trusted").
constexpr double kMissingRaysError = 0.15;
// Of a range resolution that nothing but what is usual tells, by the standard error that it has then: with 15 cm taken
// for 8 to 25 areas were off by 0.56 to 1.15 (docs/beams-fits.md, "The range resolution").
constexpr double kAssumedResolutionError = 0.1, kUsualResolutionErrorM = 0.08;
// Of leaves whose size is not measured: half as large or twice as large moves the mean echo by a tenth.
constexpr double kUnknownLeafError = 0.1;
constexpr double kNoteworthyBrightness = 0.1;  // of wood, away from that of leaves
// What earlier echoes took of a beam whose last one is reported is made up for where echoes are weighed; where they are
// counted, or of canes, thin wood is missing, behind which the ground gives another echo.
constexpr double kLastWeighedError = 0.05, kLastCountedError = 0.25;

double diameter_of(const tile::ScanEntry& scan) { return scan.beam ? scan.beam->diameter_at(kTypicalRangeM) : 0; }

/// Of the logarithm of areas whose echoes are weighed.
double weighed_error(const EchoModel& model) {
  if (model.wood_returned) return model.full_echo_error;
  const double of_full_echo = (kErrorOfFullEcho + kErrorPerLeaf * model.leaves_per_resolution) * model.full_echo_error;
  const double of_angle = kErrorOfAngle * model.angle_slope * model.angle_slope;
  return std::hypot(kTogether * std::hypot(kLawError, kErrorOfLost * model.lost_share, of_full_echo), of_angle);
}

double error_of_resolution(const EchoModel& model) {
  if (!model.resolution_assumed) return 0;
  return kAssumedResolutionError * std::min(1.0, model.range_resolution_error_m / kUsualResolutionErrorM);
}

double error_of(const tile::ScanEntry& scan, const std::optional<EchoModel>& model) {
  if (diameter_of(scan) <= kThinM) return 0;
  const bool last = scan.beam->returns == ReturnMode::last;
  if (model) {
    const double of_last = model->wood_returned ? kLastCountedError : kLastWeighedError;
    const bool unknown_leaf = !model->wood_returned && model->leaf_size_from == LeafSizeFrom::nothing;
    return std::hypot(std::hypot(weighed_error(*model), unknown_leaf ? kUnknownLeafError : 0, model->wood_error),
                      std::hypot(model->lacks_downward_misses ? kMissingRaysError : 0, error_of_resolution(*model),
                                 last ? of_last : 0));
  }
  return std::hypot(std::min(kMostCountedError, kCountedErrorPerM * diameter_of(scan)), last ? kLastCountedError : 0);
}

}  // namespace

Foliage foliage_of(const tile::ScanEntry& scan, const std::string& crs) {
  if (scan.dormant) return *scan.dormant ? Foliage::none : Foliage::likely;
  const std::optional<double> latitude_deg = latitude_of(scan, crs);
  if (!latitude_deg) return Foliage::unknown;
  if (is_leafless_season(scan.date, *latitude_deg)) return Foliage::unlikely;
  return is_full_leaf_season(scan.date, *latitude_deg) ? Foliage::likely : Foliage::unknown;
}

bool has_thin_beam(const tile::ScanEntry& scan) { return diameter_of(scan) <= kThinM; }

std::shared_ptr<const BeamView> view_of(const tile::ScanEntry& scan, const ScanSurvey& survey,
                                        const BeamOptions& options) {
  if (!options.enabled || diameter_of(scan) <= kThinM) return nullptr;
  return std::make_shared<const BeamView>(beam_view(*scan.beam, SensorTrack(survey.path()), options));
}

Result<std::optional<EchoModel>> measure_echoes(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                                const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                                const std::shared_ptr<const BeamView>& view) {
  if (!view) return std::nullopt;
  const double sample_m = work.options.voxel_fit.sample_m;
  KeyBuilder key(kEchoModelKind, kEchoesVersion);
  key.add(option_numbers(work.options.segments)).add(option_numbers(work.voxels));
  key.add(option_numbers(work.options.beam)).add(work.options.estimator.leaf_size_m2).add(sample_m);
  const Foliage foliage = foliage_of(work.scan, work.store.config().crs);
  const double wood_per_side = work.options.wood.enabled ? work.options.wood.per_side : 0;
  key.add(static_cast<double>(foliage)).add(wood_per_side);
  add_beam(key, view->beam);
  key.add(static_cast<double>(kSpotsVersion));
  key.add(work.layout_key).add(work.files.sha256("profile", "block"));
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(
        const RowSegmentList row_segments,
        make_row_segments(layout, surveyed.ground, profile, with_voxel_size(work.options.segments, sample_m)));
    RAYFIELD_ASSIGN(const SampledEchoes sampled, sample_echoes(work, row_segments, wood, view));
    if (!sampled.statistics) return arrays_from_echo_model(std::nullopt);
    RAYFIELD_ASSIGN(const BelievedResolution resolution, range_resolution_of_scan(work, surveyed, *sampled.statistics));
    auto model =
        estimate_echo_model(*sampled.statistics, {view->beam, resolution.value_m, work.options.beam.full_echo,
                                                  work.options.estimator.leaf_size_m2, wood_per_side, foliage});
    if (model) {
      model->lacks_downward_misses = work.voxels.sure_return_m > 0;
      model->resolution_assumed = !is_known(resolution);
      model->range_resolution_error_m = resolution.error_m;
    }
    return arrays_from_echo_model(model);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get(kEchoModelKind, "block", key.hex(), make));
  return echo_model_from_arrays(arrays);
}

std::shared_ptr<const BeamView> view_with(const std::shared_ptr<const BeamView>& view,
                                          const std::optional<EchoModel>& model) {
  if (!view || !model) return nullptr;
  BeamView known = *view;
  known.beam.range_resolution_m = model->range_resolution_m;
  known.behind_m = kBehindResolutions * model->range_resolution_m;
  return std::make_shared<const BeamView>(std::move(known));
}

Result<std::optional<EchoModel>> read_echoes(const tile::Store& store, const tile::ScanEntry& scan) {
  for (const tile::DerivedEntry& entry : scan.derived) {
    if (entry.kind != kEchoModelKind) continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
    return echo_model_from_arrays(arrays);
  }
  return std::nullopt;
}

void add_beam(KeyBuilder& key, const LidarBeam& beam) {
  key.add(beam.diameter_m).add(beam.divergence_rad);
  key.add(beam.detection_share.value_or(-1)).add(beam.range_resolution_m.value_or(-1));
  if (beam.returns) key.add(name_of(*beam.returns));
}

IntegrationOptions integration_with_beam(const IntegrationOptions& integration, const tile::ScanEntry& scan,
                                         const std::optional<EchoModel>& model) {
  IntegrationOptions options = integration;
  options.shared_error = std::min(1.0, std::hypot(options.shared_error, error_of(scan, model)));
  return options;
}

std::string beam_note(const tile::ScanEntry& scan, const std::optional<EchoModel>& model) {
  const double diameter = diameter_of(scan), error = error_of(scan, model);
  if (error == 0) return {};
  std::string note = fmt::format("the beam of {}'s lidar is {:.0f} mm wide at {:.0f} m, ", scan.scan_id,
                                 1000 * diameter, kTypicalRangeM);
  if (!model)
    return note + fmt::format(
                      "and its echoes do not tell what they hold of it (no intensities, too few, or mostly of "
                      "wood): areas but those of posts and trunks are off by a factor of about {:.1f} either way, and "
                      "their intervals say so",
                      std::exp(error));
  if (model->wood_returned)
    return note +
           fmt::format(
               "which is taken out as of bare vines, whose canes are taken to be as bright as trunks: a "
               "full echo is {:.0f}, the weakest {:.2f} of it, and {:.0f} % of what canes take is in echoes; what "
               "is left is about {:.0f} %, in the intervals",
               model->full_echo, model->detection_share, 100 * *model->wood_returned, 100 * error);
  note += fmt::format("which is taken out: a full echo is {:.0f} ± {:.0f}, the weakest {:.2f} of it, leaves {:.0f} cm²",
                      model->full_echo, model->full_echo * model->full_echo_error, model->detection_share,
                      1e4 * model->leaf_size_m2);
  if (model->leaf_size_from == LeafSizeFrom::nothing) note += " (not measured: neighbouring beams are too far apart)";
  if (!model->resolution_assumed)
    note += fmt::format(", range resolution {:.0f} cm", 100 * model->range_resolution_m);
  else
    note += fmt::format(
        "; how far apart its echoes are told is not known well, {:.0f} ± {:.0f} cm are assumed "
        "(`lidar.range_resolution_m` of the rig)",
        100 * model->range_resolution_m, 100 * model->range_resolution_error_m);
  if (model->wood_per_side > 0 && std::abs(1 - model->wood_brightness) > kNoteworthyBrightness)
    note += fmt::format("; wood is {:.2f} times as bright as leaves", model->wood_brightness);
  if (model->lacks_downward_misses)
    note += "; the cloud lacks the downward rays without a return, so that areas may be a third too large";
  if (scan.beam->returns == ReturnMode::last)
    note +=
        "; its lidar reports the last echo, and what earlier ones took, up to half of the area, is made up for: the "
        "first would be surer";
  if (!scan.beam->returns)
    note +=
        "; nothing says which of several echoes its lidar reports (`lidar.returns` of the rig), so the first is "
        "assumed";
  return note + fmt::format("; what is left is about {:.0f} %, in the intervals", 100 * error);
}

}  // namespace rayfield::density
