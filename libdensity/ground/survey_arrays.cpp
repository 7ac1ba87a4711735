#include "libdensity/ground/survey_arrays.h"

#include <cmath>
#include <limits>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

// NaN cannot stand in JSON.
nlohmann::json or_null(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

double null_is_nan(const nlohmann::json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_number() ? it->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Result<void> read_bins(const tile::ArraySet& arrays, TileSurvey& survey) {
  const std::size_t cells = static_cast<std::size_t>(survey.cells) * static_cast<std::size_t>(survey.cells);
  RAYFIELD_ASSIGN(const auto counts, stored_column<std::uint16_t>(arrays, "cell_bins", cells));
  survey.bin_begin.assign(1, 0);
  for (const std::uint16_t n : counts) survey.bin_begin.push_back(survey.bin_begin.back() + n);
  const std::size_t n = survey.bin_begin.back();
  RAYFIELD_ASSIGN(const auto key, stored_column<std::int32_t>(arrays, "bin_key", n));
  RAYFIELD_ASSIGN(const auto count, stored_column<std::uint32_t>(arrays, "bin_count", n));
  RAYFIELD_ASSIGN(const auto sum, stored_column<std::int64_t>(arrays, "bin_sum", n));
  survey.bins.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (count[i] == 0) return damaged(arrays, "a bin without hits");
    survey.bins[i] = {key[i], count[i], sum[i]};
  }
  return {};
}

Result<void> read_path(const tile::ArraySet& arrays, TileSurvey& survey) {
  RAYFIELD_ASSIGN(const auto step, arrays.column<std::int64_t>("path_step"));
  RAYFIELD_ASSIGN(const auto count, stored_column<std::int64_t>(arrays, "path_count", step.size()));
  RAYFIELD_ASSIGN(const auto east, stored_column<std::int64_t>(arrays, "path_east", step.size()));
  RAYFIELD_ASSIGN(const auto north, stored_column<std::int64_t>(arrays, "path_north", step.size()));
  RAYFIELD_ASSIGN(const auto up, stored_column<std::int64_t>(arrays, "path_up", step.size()));
  for (std::size_t i = 0; i < step.size(); ++i) {
    if (count[i] <= 0) return damaged(arrays, "a path step without rays");
    survey.path.push_back({step[i], count[i], east[i], north[i], up[i]});
  }
  return {};
}

}  // namespace

tile::ArraySet survey_to_arrays(const TileSurvey& s) {
  tile::ArraySet out;
  out.kind = "survey", out.version = 2;
  out.attributes = nlohmann::json{{"ix", s.index.ix},
                                  {"iy", s.index.iy},
                                  {"tile_size_m", s.tile_size_m},
                                  {"path_step_s", s.path_step_s},
                                  {"bin_m", s.bin_m},
                                  {"cells", s.cells},
                                  {"coverage_cells", s.coverage.nx},
                                  {"segments", s.segments},
                                  {"starts", s.starts},
                                  {"ends", s.ends},
                                  {"hits", s.hits},
                                  {"misses_above", s.misses.above},
                                  {"misses_below", s.misses.below},
                                  {"first_time_s", s.first_time_s},
                                  {"last_time_s", s.last_time_s},
                                  {"lowest_hit_m", or_null(s.lowest_hit_m)},
                                  {"highest_hit_m", or_null(s.highest_hit_m)}}
                       .dump();
  std::vector<std::uint16_t> cell_bins;
  for (std::size_t i = 1; i < s.bin_begin.size(); ++i)
    cell_bins.push_back(static_cast<std::uint16_t>(s.bin_begin[i] - s.bin_begin[i - 1]));
  std::vector<std::int32_t> key;
  std::vector<std::uint32_t> count;
  std::vector<std::int64_t> sum, step, path_count, east, north, up;
  for (const LowBin& bin : s.bins) key.push_back(bin.key), count.push_back(bin.count), sum.push_back(bin.sum);
  for (const PathSum& p : s.path) {
    step.push_back(p.step), path_count.push_back(p.count);
    east.push_back(p.east), north.push_back(p.north), up.push_back(p.up);
  }
  out.columns["cell_bins"] = std::move(cell_bins);
  out.columns["bin_key"] = std::move(key), out.columns["bin_count"] = std::move(count),
  out.columns["bin_sum"] = std::move(sum);
  out.columns["path_step"] = std::move(step), out.columns["path_count"] = std::move(path_count);
  out.columns["path_east"] = std::move(east), out.columns["path_north"] = std::move(north),
  out.columns["path_up"] = std::move(up);
  out.columns["coverage"] = s.coverage.values;
  return out;
}

Result<TileSurvey> survey_from_arrays(const tile::ArraySet& arrays) {
  constexpr int kMostCells = 10000, kIndex = std::numeric_limits<int>::max();
  RAYFIELD_ASSIGN(const nlohmann::json json, stored_attributes(arrays, "survey", 2));
  TileSurvey s;
  RAYFIELD_ASSIGN(s.index.ix, stored_count(arrays, json, "ix", -kIndex, kIndex));
  RAYFIELD_ASSIGN(s.index.iy, stored_count(arrays, json, "iy", -kIndex, kIndex));
  RAYFIELD_ASSIGN(s.tile_size_m, stored_number(arrays, json, "tile_size_m"));
  RAYFIELD_ASSIGN(s.path_step_s, stored_number(arrays, json, "path_step_s"));
  RAYFIELD_ASSIGN(s.bin_m, stored_number(arrays, json, "bin_m"));
  RAYFIELD_ASSIGN(s.cells, stored_count(arrays, json, "cells", 1, kMostCells));
  RAYFIELD_ASSIGN(const int coverage, stored_count(arrays, json, "coverage_cells", 1, kMostCells));
  if (!(s.tile_size_m > 0) || !(s.bin_m > 0) || !(s.path_step_s > 0)) return damaged(arrays, "a size is not positive");
  RAYFIELD_ASSIGN(s.segments, stored_total(arrays, json, "segments"));
  RAYFIELD_ASSIGN(s.starts, stored_total(arrays, json, "starts"));
  RAYFIELD_ASSIGN(s.ends, stored_total(arrays, json, "ends"));
  RAYFIELD_ASSIGN(s.hits, stored_total(arrays, json, "hits"));
  RAYFIELD_ASSIGN(s.misses.above, stored_total(arrays, json, "misses_above"));
  RAYFIELD_ASSIGN(s.misses.below, stored_total(arrays, json, "misses_below"));
  RAYFIELD_ASSIGN(s.first_time_s, stored_number(arrays, json, "first_time_s"));
  RAYFIELD_ASSIGN(s.last_time_s, stored_number(arrays, json, "last_time_s"));
  s.lowest_hit_m = null_is_nan(json, "lowest_hit_m"), s.highest_hit_m = null_is_nan(json, "highest_hit_m");
  RAYFIELD_CHECK(read_bins(arrays, s));
  RAYFIELD_CHECK(read_path(arrays, s));
  const std::size_t cells = static_cast<std::size_t>(coverage) * static_cast<std::size_t>(coverage);
  RAYFIELD_ASSIGN(const auto mask, stored_column<std::uint8_t>(arrays, "coverage", cells));
  s.coverage = Grid2<std::uint8_t>(Eigen::Vector2d(s.index.ix, s.index.iy) * s.tile_size_m, s.tile_size_m / coverage,
                                   coverage, coverage);
  s.coverage.values.assign(mask.begin(), mask.end());
  return s;
}

}  // namespace rayfield::density
