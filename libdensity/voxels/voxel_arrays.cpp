#include "libdensity/voxels/voxel_arrays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace rayfield::density {
namespace {

constexpr const char* kKind = "voxels";
constexpr int kVersion = 3;
constexpr std::size_t kReals = 11, kInts = 6;  // per row segment

template <class T>
std::vector<T>& column(tile::ArraySet& set, const char* name) {
  return std::get<std::vector<T>>(set.columns.try_emplace(name, std::vector<T>{}).first->second);
}

tl::unexpected<Error> damaged(const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read counted voxels", kKind, why, "run `rayfield verify`");
}

void push_row_segment(const RowSegment& s, std::vector<double>& reals, std::vector<std::int32_t>& ints) {
  for (const double x : {s.origin.x(), s.origin.y(), s.direction.x(), s.direction.y(), s.chainage_m, s.ground_m,
                         s.slope_along, s.slope_across, s.voxel_m})
    reals.push_back(x);
  reals.push_back(s.across_min_m), reals.push_back(s.up_min_m);
  for (const int x : {s.row, s.index, s.first_along, s.n_along, s.n_across, s.n_up}) ints.push_back(x);
}

Result<RowSegment> pull_row_segment(std::span<const double> reals, std::span<const std::int32_t> ints) {
  RowSegment s;
  s.origin = {reals[0], reals[1]}, s.direction = {reals[2], reals[3]};
  s.chainage_m = reals[4], s.ground_m = reals[5], s.slope_along = reals[6], s.slope_across = reals[7],
  s.voxel_m = reals[8];
  s.across_min_m = reals[9], s.up_min_m = reals[10];
  s.row = ints[0], s.index = ints[1], s.first_along = ints[2], s.n_along = ints[3], s.n_across = ints[4],
  s.n_up = ints[5];
  for (const double x : reals)
    if (!std::isfinite(x)) return damaged("a row segment has numbers that are not finite");
  if (s.n_along <= 0 || s.n_across <= 0 || s.n_up <= 0 || std::int64_t{s.n_along} * s.n_across > kMostVoxels ||
      std::int64_t{s.n_along} * s.n_across * s.n_up > kMostVoxels || !(s.voxel_m > 0) ||
      !(std::abs(s.direction.norm() - 1) < 1e-6))
    return damaged("a row segment has impossible dimensions");
  return s;
}

/// The columns of the file, as spans; where reading has got to in each.
struct Cursor {
  std::span<const std::int32_t> column;
  std::span<const std::uint32_t> entries, rays, hits;
  std::span<const std::int64_t> path, potential, hit_path;
  std::size_t at_column = 0, at_entry = 0, at_voxel = 0, at_hit = 0;
};

Result<Cursor> open(const tile::ArraySet& a) {
  Cursor c;
  RAYFIELD_ASSIGN(c.column, a.column<std::int32_t>("column"));
  RAYFIELD_ASSIGN(c.entries, a.column<std::uint32_t>("entries"));
  RAYFIELD_ASSIGN(c.rays, a.column<std::uint32_t>("rays"));
  RAYFIELD_ASSIGN(c.hits, a.column<std::uint32_t>("hits"));
  RAYFIELD_ASSIGN(c.path, a.column<std::int64_t>("path"));
  RAYFIELD_ASSIGN(c.potential, a.column<std::int64_t>("potential"));
  RAYFIELD_ASSIGN(c.hit_path, a.column<std::int64_t>("hit_path"));
  std::size_t hit_voxels = 0;
  for (const std::uint32_t h : c.hits) hit_voxels += h > 0 ? 1u : 0u;
  if (c.rays.size() != c.hits.size() || c.rays.size() != c.path.size())
    return damaged("columns of voxels differ in length");
  for (const auto& sums : {c.potential, c.hit_path})
    if (sums.size() != hit_voxels) return damaged("sums over hits do not match the hits");
  return c;
}

Result<void> pull_voxels(Cursor& c, RowSegmentVoxels& out) {
  const RowSegment& s = out.row_segment;
  const std::size_t columns = s.shape().columns();
  if (c.column.size() - c.at_column < columns) return damaged("the table of columns is too short");
  out.column.assign(c.column.begin() + static_cast<std::ptrdiff_t>(c.at_column),
                    c.column.begin() + static_cast<std::ptrdiff_t>(c.at_column + columns));
  c.at_column += columns;
  std::int32_t next = 0;
  for (const std::int32_t number : out.column)
    if (number != -1 && number != next++) return damaged("columns are not numbered in order");
  const auto owned = static_cast<std::size_t>(next);
  const std::size_t voxels = owned * static_cast<std::size_t>(s.n_up);
  if (c.entries.size() - c.at_entry < owned || c.rays.size() - c.at_voxel < voxels)
    return damaged("voxels are missing");
  out.entries.assign(c.entries.begin() + static_cast<std::ptrdiff_t>(c.at_entry),
                     c.entries.begin() + static_cast<std::ptrdiff_t>(c.at_entry + owned));
  c.at_entry += owned;
  out.voxels.resize(voxels);
  for (VoxelCounters& v : out.voxels) {
    const std::size_t i = c.at_voxel++;
    v.rays = c.rays[i], v.hits = c.hits[i], v.path = c.path[i];
    v.potential = v.path;
    if (v.hits > v.rays || v.path < 0) return damaged("a voxel has more hits than rays, or a negative path");
    if (v.hits == 0) continue;
    const std::size_t h = c.at_hit++;
    v.potential = c.potential[h], v.hit_path = c.hit_path[h];
  }
  return {};
}

constexpr std::array<std::pair<const char*, std::int64_t EchoCounters::*>, 4> kEchoColumns = {{
    {"echo", &EchoCounters::echo},
    {"width", &EchoCounters::width},
    {"behind", &EchoCounters::behind},
    {"echo_behind", &EchoCounters::echo_behind},
}};

void push_echoes(const TileVoxels& voxels, tile::ArraySet& out) {
  for (const auto& [name, member] : kEchoColumns) {
    std::vector<std::int64_t> values;
    for (const RowSegmentVoxels& s : voxels.row_segments)
      for (const EchoCounters& e : s.echoes) values.push_back(e.*member);
    if (!values.empty()) column<std::int64_t>(out, name) = std::move(values);
  }
}

/// Counters of beams that are not thin: there for all voxels or for none.
Result<void> pull_echoes(const tile::ArraySet& a, std::vector<RowSegmentVoxels>& row_segments) {
  const auto is_there = [&](const auto& echo_column) { return a.columns.count(echo_column.first) > 0; };
  if (std::none_of(kEchoColumns.begin(), kEchoColumns.end(), is_there)) return {};
  std::size_t voxels = 0;
  for (RowSegmentVoxels& s : row_segments) {
    s.echoes.resize(s.voxels.size());
    voxels += s.voxels.size();
  }
  for (const auto& [name, member] : kEchoColumns) {
    RAYFIELD_ASSIGN(const auto values, a.column<std::int64_t>(name));
    if (values.size() != voxels) return damaged("columns of echoes differ in length from those of voxels");
    std::size_t at = 0;
    for (RowSegmentVoxels& s : row_segments)
      for (EchoCounters& e : s.echoes) {
        e.*member = values[at++];
        if (e.*member < 0) return damaged("negative sums over echoes");
      }
  }
  return {};
}

/// Calls visit(count) for every count, in the order of the file.
template <class Pairs, class Visit>
void for_counts(Pairs& pairs, Visit visit) {
  for (auto* parts : {&pairs.rays, &pairs.ends})
    for (auto& depths : *parts)
      for (auto& count : depths) visit(count);
  for (auto& count : pairs.beyond) visit(count);
}

}  // namespace

tile::ArraySet arrays_from_voxels(const TileVoxels& voxels) {
  tile::ArraySet out;
  out.kind = kKind, out.version = kVersion;
  out.attributes =
      R"({"path_unit":"voxel side * 2^-25","pairs":"rays, echoes: 16 bins of 5 mm by 40 of 10 mm of depth; beyond: 16"})";
  column<std::int32_t>(out, "tile") = {voxels.tile.ix, voxels.tile.iy};
  auto& pairs = column<std::int64_t>(out, "pairs");
  for_counts(voxels.pairs, [&](std::uint64_t n) { pairs.push_back(static_cast<std::int64_t>(n)); });
  auto& reals = column<double>(out, "stretch_reals");
  auto &ints = column<std::int32_t>(out, "stretch_ints"), &columns = column<std::int32_t>(out, "column");
  auto &entries = column<std::uint32_t>(out, "entries"), &rays = column<std::uint32_t>(out, "rays"),
       &hits = column<std::uint32_t>(out, "hits");
  auto &path = column<std::int64_t>(out, "path"), &potential = column<std::int64_t>(out, "potential");
  auto& hit_path = column<std::int64_t>(out, "hit_path");
  std::size_t count = 0;
  for (const RowSegmentVoxels& s : voxels.row_segments) count += s.voxels.size();
  rays.reserve(count), hits.reserve(count), path.reserve(count);
  for (const RowSegmentVoxels& s : voxels.row_segments) {
    push_row_segment(s.row_segment, reals, ints);
    columns.insert(columns.end(), s.column.begin(), s.column.end());
    entries.insert(entries.end(), s.entries.begin(), s.entries.end());
    for (const VoxelCounters& v : s.voxels) {
      rays.push_back(v.rays), hits.push_back(v.hits), path.push_back(v.path);
      if (v.hits == 0) continue;
      potential.push_back(v.potential), hit_path.push_back(v.hit_path);
    }
  }
  push_echoes(voxels, out);
  return out;
}

Result<TileVoxels> voxels_from_arrays(const tile::ArraySet& arrays) {
  if (arrays.kind != kKind || arrays.version != kVersion)
    return damaged("it is '" + arrays.kind + "' version " + std::to_string(arrays.version));
  RAYFIELD_ASSIGN(const auto tile, arrays.column<std::int32_t>("tile"));
  RAYFIELD_ASSIGN(const auto pairs, arrays.column<std::int64_t>("pairs"));
  RAYFIELD_ASSIGN(const auto reals, arrays.column<double>("stretch_reals"));
  RAYFIELD_ASSIGN(const auto ints, arrays.column<std::int32_t>("stretch_ints"));
  constexpr std::size_t kRealCount = kReals;
  constexpr std::size_t kPairCounts = LeafSizePairs::kBins * (2 * LeafSizePairs::kDepths + 1);
  const std::size_t count = ints.size() / kInts;
  if (tile.size() != 2 || pairs.size() != kPairCounts || ints.size() != count * kInts ||
      reals.size() != count * kRealCount)
    return damaged("tables of fixed size have another");
  TileVoxels out;
  out.tile = {tile[0], tile[1]};
  if (std::any_of(pairs.begin(), pairs.end(), [](std::int64_t n) { return n < 0; })) return damaged("negative counts");
  for_counts(out.pairs, [at = pairs.begin()](std::uint64_t& n) mutable { n = static_cast<std::uint64_t>(*at++); });
  RAYFIELD_ASSIGN(Cursor cursor, open(arrays));
  for (std::size_t i = 0; i < count; ++i) {
    RowSegmentVoxels s;
    RAYFIELD_ASSIGN(s.row_segment,
                    pull_row_segment(reals.subspan(i * kRealCount, kRealCount), ints.subspan(i * kInts, kInts)));
    RAYFIELD_CHECK(pull_voxels(cursor, s));
    out.row_segments.push_back(std::move(s));
  }
  if (cursor.at_column != cursor.column.size() || cursor.at_entry != cursor.entries.size() ||
      cursor.at_voxel != cursor.rays.size())
    return damaged("there are more voxels than row segments have");
  RAYFIELD_CHECK(pull_echoes(arrays, out.row_segments));
  return out;
}

}  // namespace rayfield::density
