#include "tests/fuzz/derived_seeds.h"

#include "libdensity/ground/ground_arrays.h"
#include "libdensity/ground/survey_arrays.h"
#include "libdensity/learning/scan_evidence.h"
#include "libdensity/registry/layout_arrays.h"
#include "libdensity/results/results_io.h"
#include "libdensity/voxels/canopy_profile_arrays.h"
#include "libdensity/voxels/row_segment_arrays.h"
#include "libdensity/voxels/voxel_arrays.h"
#include "tests/fuzz/array_bytes.h"
#include "tests/libdensity/layout_support.h"
#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::fuzz {
namespace {

using namespace density;

tile::ArraySet survey() {
  TileSurvey survey;
  survey.index = {2, -3}, survey.tile_size_m = 25, survey.cells = 2;
  survey.bin_begin = {0, 1, 1, 3, 3};
  survey.bins = {{10, 3, 100}, {-4, 1, 7}, {-3, 2, 9}};
  survey.path = {{1, 20, 3000, -4000, 50}, {2, 10, 3100, -4100, 51}};
  survey.coverage = Grid2<std::uint8_t>({50, -75}, 12.5, 2, 2);
  // Of four digits, as the words of fuzz_derived.dict.
  survey.segments = 4000, survey.starts = 1234, survey.ends = 2345, survey.hits = 1111;
  survey.misses = {1000, 2000};
  return survey_to_arrays(survey);
}

tile::ArraySet ground() {
  GroundTile ground;
  ground.nodes = Grid2<float>({50, -75}, 12.5, 3, 3);
  ground.candidates = 9, ground.known_nodes = 9;
  return ground_to_arrays({2, -3}, ground);
}

tile::ArraySet profile() {
  CanopyProfile profile;
  profile.across[1] = std::vector<std::int64_t>(150, 4);
  profile.up[1] = std::vector<std::int64_t>(20, 7);
  return profile_to_arrays(profile);
}

RowSegment small_segment() {
  RowSegment segment = density::testing::make_row_segment();
  segment.n_along = 4, segment.n_across = 3, segment.n_up = 5;
  return segment;
}

tile::ArraySet voxels(bool wide) {
  const auto view = wide ? std::make_shared<const BeamView>(BeamView{{0.01, 0.01, {}}, 0.12, SensorTrack()}) : nullptr;
  auto accumulator = VoxelAccumulator::create({{0, 0}, 1000}, std::vector{small_segment()}, {}, {}, view);
  if (!accumulator || !accumulator->add(density::testing::random_rays(small_segment(), 60, 9))) return {};
  return arrays_from_voxels(std::move(*accumulator).finish());
}

tile::ArraySet evidence(const RowLayout& layout) {
  ScanEvidence evidence;
  evidence.stems = density::testing::stems_of(layout);
  evidence.rows = {{1, true, 0.5}};
  evidence.passes = {{{0, 0}, {0, 5}}, {{3, 0}, {3, 5}, {3, 9}}};
  evidence.new_rows.rows = {density::testing::straight_row(1, 9, 3)};
  return evidence_to_arrays(evidence);
}

tile::ArraySet results() {
  ScanResults results;
  results.panel_values.resize(2), results.row_metres.resize(3);
  results.sections = {{"side_view_row_1", "m2/m3", 1, Grid2<float>({0, 0}, 0.1, 3, 2)}};
  RowLayout layout;
  layout.panels = {{1, 1, 0, 5}, {1, 2, 5, 10}};
  layout.panels[0].identity.uid = "first", layout.panels[1].identity.uid = "second";
  results.panel_values[0].panel_uid = "first", results.panel_values[1].panel_uid = "second";
  return results_to_arrays(results, layout, {}).arrays;
}

}  // namespace

std::map<std::string, std::string> derived_seeds() {
  const RowLayout layout = density::testing::trellis(1);
  RowSegmentList segments;
  segments.row_segments = {small_segment()};
  RasterProduct raster{"ground", "m", "height", Grid2<float>({0, 0}, 1, 3, 2)};
  return {{"survey", pack(survey())},
          {"ground", pack(ground())},
          {"profile", pack(profile())},
          {"voxels_thin", pack(voxels(false))},
          {"voxels_wide", pack(voxels(true))},
          {"row_segments", pack(row_segments_to_arrays(segments))},
          {"layout", pack(layout_to_arrays(layout))},
          {"evidence", pack(evidence(layout))},
          {"results", pack(results())},
          {"raster", pack(raster_to_arrays(raster, {}).arrays)}};
}

}  // namespace rayfield::fuzz
