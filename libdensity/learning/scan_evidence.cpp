#include "libdensity/learning/scan_evidence.h"

#include <utility>

#include "libdensity/registry/layout_arrays.h"
#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

constexpr const char* kKind = "stems";
constexpr const char* kNewRows = "new_";  // before the names of the columns that hold the new rows

// The numbers of a stem and the columns that they stand in.
constexpr std::pair<const char*, double Stem::*> kStemColumns[] = {{"stem_radius_m", &Stem::radius_m},
                                                                   {"stem_top_m", &Stem::top_m},
                                                                   {"stem_contrast", &Stem::contrast},
                                                                   {"stem_upper_share", &Stem::upper_share},
                                                                   {"stem_solidity", &Stem::solidity}};

void put_stems(const std::vector<Stem>& stems, tile::ArraySet& out) {
  std::vector<std::int32_t> row;
  std::vector<double> east, north, lean_east, lean_north;
  for (const Stem& stem : stems) {
    row.push_back(stem.row);
    east.push_back(stem.position.x()), north.push_back(stem.position.y());
    lean_east.push_back(stem.lean.x()), lean_north.push_back(stem.lean.y());
  }
  out.columns["stem_row"] = std::move(row);
  out.columns["stem_easting_m"] = std::move(east), out.columns["stem_northing_m"] = std::move(north);
  out.columns["stem_lean_east"] = std::move(lean_east), out.columns["stem_lean_north"] = std::move(lean_north);
  for (const auto& [name, member] : kStemColumns) {
    std::vector<double> column;
    for (const Stem& stem : stems) column.push_back(stem.*member);
    out.columns[name] = std::move(column);
  }
}

Result<std::vector<Stem>> get_stems(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("stem_row"));
  const std::size_t n = row.size();
  RAYFIELD_ASSIGN(const auto east, stored_column<double>(arrays, "stem_easting_m", n));
  RAYFIELD_ASSIGN(const auto north, stored_column<double>(arrays, "stem_northing_m", n));
  RAYFIELD_ASSIGN(const auto lean_east, stored_column<double>(arrays, "stem_lean_east", n));
  RAYFIELD_ASSIGN(const auto lean_north, stored_column<double>(arrays, "stem_lean_north", n));
  std::vector<Stem> stems(n);
  for (std::size_t i = 0; i < n; ++i) {
    stems[i].row = row[i];
    stems[i].position = {east[i], north[i]}, stems[i].lean = {lean_east[i], lean_north[i]};
  }
  for (const auto& [name, member] : kStemColumns) {
    RAYFIELD_ASSIGN(const auto column, stored_column<double>(arrays, name, n));
    for (std::size_t i = 0; i < n; ++i) stems[i].*member = column[i];
  }
  return stems;
}

}  // namespace

tile::ArraySet evidence_to_arrays(const ScanEvidence& evidence) {
  tile::ArraySet out;
  out.kind = kKind;
  put_stems(evidence.stems, out);
  std::vector<std::int32_t> row, vertices;
  std::vector<std::uint8_t> canopy;
  std::vector<double> driven, east, north;
  for (const ScanEvidence::RowSighting& sighting : evidence.rows) {
    row.push_back(sighting.row), canopy.push_back(sighting.canopy), driven.push_back(sighting.driven);
  }
  for (const auto& pass : evidence.passes) {
    vertices.push_back(static_cast<std::int32_t>(pass.size()));
    for (const Eigen::Vector2d& p : pass) east.push_back(p.x()), north.push_back(p.y());
  }
  out.columns["row_number"] = std::move(row), out.columns["row_canopy"] = std::move(canopy);
  out.columns["row_driven"] = std::move(driven), out.columns["pass_vertices"] = std::move(vertices);
  out.columns["pass_easting_m"] = std::move(east), out.columns["pass_northing_m"] = std::move(north);
  tile::ArraySet rows = layout_to_arrays(evidence.new_rows);
  for (auto& [name, column] : rows.columns) out.columns[kNewRows + name] = std::move(column);
  out.attributes = rows.attributes;
  return out;
}

Result<ScanEvidence> evidence_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_CHECK(stored_attributes(arrays, kKind, 1));
  ScanEvidence evidence;
  RAYFIELD_ASSIGN(evidence.stems, get_stems(arrays));
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("row_number"));
  RAYFIELD_ASSIGN(const auto canopy, stored_column<std::uint8_t>(arrays, "row_canopy", row.size()));
  RAYFIELD_ASSIGN(const auto driven, stored_column<double>(arrays, "row_driven", row.size()));
  for (std::size_t i = 0; i < row.size(); ++i) evidence.rows.push_back({row[i], canopy[i] != 0, driven[i]});
  RAYFIELD_ASSIGN(const auto vertices, arrays.column<std::int32_t>("pass_vertices"));
  RAYFIELD_ASSIGN(const auto east, arrays.column<double>("pass_easting_m"));
  RAYFIELD_ASSIGN(const auto north, stored_column<double>(arrays, "pass_northing_m", east.size()));
  std::size_t at = 0;
  for (const std::int32_t count : vertices) {
    if (count < 0 || static_cast<std::size_t>(count) > east.size() - at)
      return damaged(arrays, "a pass has an impossible number of vertices");
    std::vector<Eigen::Vector2d>& pass = evidence.passes.emplace_back();
    for (std::int32_t i = 0; i < count; ++i, ++at) pass.emplace_back(east[at], north[at]);
  }
  tile::ArraySet rows;
  rows.kind = "rows", rows.attributes = arrays.attributes;
  for (const auto& [name, column] : arrays.columns)
    if (name.rfind(kNewRows, 0) == 0) rows.columns[name.substr(std::string_view(kNewRows).size())] = column;
  RAYFIELD_ASSIGN(evidence.new_rows, layout_from_arrays(rows));
  return evidence;
}

}  // namespace rayfield::density
