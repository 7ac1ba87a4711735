#include "libdensity/registry/layout_arrays.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

using Numbers = std::vector<double>;
using Integers = std::vector<std::int32_t>;
using Flags = std::vector<std::uint8_t>;

// A column of texts: each followed by a line feed.
Flags texts_to_bytes(const std::vector<std::string>& texts) {
  Flags bytes;
  for (const std::string& text : texts) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back('\n');
  }
  return bytes;
}

// Layouts of earlier versions have no such columns: every text is then empty.
Result<std::vector<std::string>> texts(const tile::ArraySet& arrays, const std::string& name, std::size_t length) {
  std::vector<std::string> out;
  if (arrays.columns.count(name) == 0) return std::vector<std::string>(length);
  RAYFIELD_ASSIGN(const auto bytes, arrays.column<std::uint8_t>(name));
  std::string text;
  for (const std::uint8_t byte : bytes) {
    if (byte != '\n') {
      text += static_cast<char>(byte);
      continue;
    }
    out.push_back(std::move(text));
    text.clear();
  }
  if (out.size() != length || !text.empty())
    return damaged(arrays, "column '" + name + "' has " + std::to_string(out.size()) + " texts, expected " +
                               std::to_string(length));
  return out;
}

// The texts of an identity and the columns that they stand in.
constexpr std::pair<const char*, std::string Identity::*> kIdentityColumns[] = {
    {"uid", &Identity::uid},           {"valid_from", &Identity::valid_from},
    {"valid_to", &Identity::valid_to}, {"used_from", &Identity::used_from},
    {"used_to", &Identity::used_to},   {"source", &Identity::source}};

template <class Things>
void put_identities(const std::string& prefix, const Things& things, tile::ArraySet& out) {
  for (const auto& [name, member] : kIdentityColumns) {
    std::vector<std::string> column;
    for (const auto& thing : things) column.push_back(thing.identity.*member);
    out.columns[prefix + name] = texts_to_bytes(column);
  }
}

template <class Things>
Result<void> get_identities(const tile::ArraySet& arrays, const std::string& prefix, Things& things) {
  for (const auto& [name, member] : kIdentityColumns) {
    RAYFIELD_ASSIGN(std::vector<std::string> column, texts(arrays, prefix + name, things.size()));
    for (std::size_t i = 0; i < things.size(); ++i) things[i].identity.*member = std::move(column[i]);
  }
  return {};
}

void put_rows(const RowLayout& layout, tile::ArraySet& out) {
  Integers number, vertices;
  Flags left, right;
  Numbers east, north;
  for (const Row& row : layout.rows) {
    number.push_back(row.number), vertices.push_back(static_cast<std::int32_t>(row.centreline.size()));
    left.push_back(row.seen_from_left), right.push_back(row.seen_from_right);
    for (const auto& p : row.centreline) east.push_back(p.x()), north.push_back(p.y());
  }
  out.columns["row_number"] = std::move(number), out.columns["row_vertices"] = std::move(vertices);
  out.columns["row_seen_from_left"] = std::move(left), out.columns["row_seen_from_right"] = std::move(right);
  out.columns["vertex_easting_m"] = std::move(east), out.columns["vertex_northing_m"] = std::move(north);
  Integers farm_number;
  std::vector<std::string> name;
  for (const Row& row : layout.rows) farm_number.push_back(row.farm_number), name.push_back(row.name);
  out.columns["row_farm_number"] = std::move(farm_number), out.columns["row_name"] = texts_to_bytes(name);
  put_identities("row_", layout.rows, out);
}

void put_panels(const RowLayout& layout, tile::ArraySet& out) {
  Integers row, number;
  Numbers start, end;
  for (const Panel& p : layout.panels) {
    row.push_back(p.row), number.push_back(p.number), start.push_back(p.start_m), end.push_back(p.end_m);
  }
  out.columns["panel_row"] = std::move(row), out.columns["panel_number"] = std::move(number);
  out.columns["panel_start_m"] = std::move(start), out.columns["panel_end_m"] = std::move(end);
  put_identities("panel_", layout.panels, out);
}

void put_posts(const RowLayout& layout, tile::ArraySet& out) {
  Integers row;
  Flags detected;
  Numbers chainage, across, east, north, height, radius, lean_east, lean_north;
  for (const Post& p : layout.posts) {
    row.push_back(p.row), detected.push_back(p.detected), chainage.push_back(p.chainage_m),
        across.push_back(p.across_m);
    east.push_back(p.position.x()), north.push_back(p.position.y()), height.push_back(p.height_m);
    radius.push_back(p.radius_m), lean_east.push_back(p.lean.x()), lean_north.push_back(p.lean.y());
  }
  out.columns["post_row"] = std::move(row), out.columns["post_detected"] = std::move(detected);
  out.columns["post_chainage_m"] = std::move(chainage), out.columns["post_across_m"] = std::move(across);
  out.columns["post_easting_m"] = std::move(east), out.columns["post_northing_m"] = std::move(north);
  out.columns["post_height_m"] = std::move(height), out.columns["post_radius_m"] = std::move(radius);
  out.columns["post_lean_east"] = std::move(lean_east), out.columns["post_lean_north"] = std::move(lean_north);
  put_identities("post_", layout.posts, out);
}

void put_trunks(const RowLayout& layout, tile::ArraySet& out) {
  Integers row;
  Numbers chainage, across, east, north, radius, top;
  for (const Trunk& t : layout.trunks) {
    row.push_back(t.row), chainage.push_back(t.chainage_m), across.push_back(t.across_m);
    east.push_back(t.position.x()), north.push_back(t.position.y()), radius.push_back(t.radius_m),
        top.push_back(t.top_m);
  }
  out.columns["trunk_row"] = std::move(row);
  out.columns["trunk_chainage_m"] = std::move(chainage), out.columns["trunk_across_m"] = std::move(across);
  out.columns["trunk_easting_m"] = std::move(east), out.columns["trunk_northing_m"] = std::move(north);
  out.columns["trunk_radius_m"] = std::move(radius), out.columns["trunk_top_m"] = std::move(top);
}

Result<void> get_rows(const tile::ArraySet& arrays, RowLayout& layout) {
  RAYFIELD_ASSIGN(const auto number, arrays.column<std::int32_t>("row_number"));
  RAYFIELD_ASSIGN(const auto vertices, stored_column<std::int32_t>(arrays, "row_vertices", number.size()));
  RAYFIELD_ASSIGN(const auto left, stored_column<std::uint8_t>(arrays, "row_seen_from_left", number.size()));
  RAYFIELD_ASSIGN(const auto right, stored_column<std::uint8_t>(arrays, "row_seen_from_right", number.size()));
  RAYFIELD_ASSIGN(const auto east, arrays.column<double>("vertex_easting_m"));
  RAYFIELD_ASSIGN(const auto north, stored_column<double>(arrays, "vertex_northing_m", east.size()));
  std::size_t at = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (vertices[i] < 2 || static_cast<std::size_t>(vertices[i]) > east.size() - at)
      return damaged(arrays, "row " + std::to_string(number[i]) + " has an impossible number of vertices");
    Row row;
    row.number = number[i], row.seen_from_left = left[i] != 0, row.seen_from_right = right[i] != 0;
    for (int v = 0; v < vertices[i]; ++v, ++at) row.centreline.emplace_back(east[at], north[at]);
    layout.rows.push_back(std::move(row));
  }
  if (at != east.size()) return damaged(arrays, "vertices that belong to no row");
  RAYFIELD_ASSIGN(std::vector<std::string> names, texts(arrays, "row_name", number.size()));
  for (std::size_t i = 0; i < names.size(); ++i) layout.rows[i].name = std::move(names[i]);
  if (arrays.columns.count("row_farm_number") > 0) {
    RAYFIELD_ASSIGN(const auto farm_number, stored_column<std::int32_t>(arrays, "row_farm_number", number.size()));
    for (std::size_t i = 0; i < number.size(); ++i) layout.rows[i].farm_number = farm_number[i];
  }
  return get_identities(arrays, "row_", layout.rows);
}

Result<void> get_panels(const tile::ArraySet& arrays, RowLayout& layout) {
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("panel_row"));
  RAYFIELD_ASSIGN(const auto number, stored_column<std::int32_t>(arrays, "panel_number", row.size()));
  RAYFIELD_ASSIGN(const auto start, stored_column<double>(arrays, "panel_start_m", row.size()));
  RAYFIELD_ASSIGN(const auto end, stored_column<double>(arrays, "panel_end_m", row.size()));
  for (std::size_t i = 0; i < row.size(); ++i) layout.panels.push_back({row[i], number[i], start[i], end[i]});
  return get_identities(arrays, "panel_", layout.panels);
}

Result<void> get_posts(const tile::ArraySet& arrays, RowLayout& layout) {
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("post_row"));
  const std::size_t n = row.size();
  RAYFIELD_ASSIGN(const auto detected, stored_column<std::uint8_t>(arrays, "post_detected", n));
  RAYFIELD_ASSIGN(const auto chainage, stored_column<double>(arrays, "post_chainage_m", n));
  RAYFIELD_ASSIGN(const auto across, stored_column<double>(arrays, "post_across_m", n));
  RAYFIELD_ASSIGN(const auto east, stored_column<double>(arrays, "post_easting_m", n));
  RAYFIELD_ASSIGN(const auto north, stored_column<double>(arrays, "post_northing_m", n));
  RAYFIELD_ASSIGN(const auto height, stored_column<double>(arrays, "post_height_m", n));
  RAYFIELD_ASSIGN(const auto radius, stored_column<double>(arrays, "post_radius_m", n));
  RAYFIELD_ASSIGN(const auto lean_east, stored_column<double>(arrays, "post_lean_east", n));
  RAYFIELD_ASSIGN(const auto lean_north, stored_column<double>(arrays, "post_lean_north", n));
  for (std::size_t i = 0; i < n; ++i) {
    Post post;
    post.row = row[i], post.detected = detected[i] != 0, post.chainage_m = chainage[i], post.across_m = across[i];
    post.position = {east[i], north[i]}, post.lean = {lean_east[i], lean_north[i]};
    post.height_m = height[i], post.radius_m = radius[i];
    layout.posts.push_back(post);
  }
  return get_identities(arrays, "post_", layout.posts);
}

Result<void> get_trunks(const tile::ArraySet& arrays, RowLayout& layout) {
  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("trunk_row"));
  const std::size_t n = row.size();
  RAYFIELD_ASSIGN(const auto chainage, stored_column<double>(arrays, "trunk_chainage_m", n));
  RAYFIELD_ASSIGN(const auto across, stored_column<double>(arrays, "trunk_across_m", n));
  RAYFIELD_ASSIGN(const auto east, stored_column<double>(arrays, "trunk_easting_m", n));
  RAYFIELD_ASSIGN(const auto north, stored_column<double>(arrays, "trunk_northing_m", n));
  RAYFIELD_ASSIGN(const auto radius, stored_column<double>(arrays, "trunk_radius_m", n));
  RAYFIELD_ASSIGN(const auto top, stored_column<double>(arrays, "trunk_top_m", n));
  for (std::size_t i = 0; i < n; ++i)
    layout.trunks.push_back({row[i], chainage[i], across[i], {east[i], north[i]}, radius[i], top[i]});
  return {};
}

}  // namespace

tile::ArraySet layout_to_arrays(const RowLayout& layout, const std::string& kind) {
  tile::ArraySet out;
  out.kind = kind, out.version = 1;
  nlohmann::json json{{"unit", "m"}};
  json["spacing_m"] = std::isfinite(layout.spacing_m) ? nlohmann::json(layout.spacing_m) : nlohmann::json();
  out.attributes = json.dump();
  put_rows(layout, out), put_panels(layout, out), put_posts(layout, out), put_trunks(layout, out);
  return out;
}

Result<RowLayout> layout_from_arrays(const tile::ArraySet& arrays) {
  const bool of_layout = arrays.kind == "survey" || arrays.kind == "found";
  RAYFIELD_ASSIGN(const nlohmann::json json, stored_attributes(arrays, of_layout ? arrays.kind : "rows", 1));
  RowLayout layout;
  const auto spacing = json.find("spacing_m");
  if (spacing == json.end()) return damaged(arrays, "attribute 'spacing_m' is missing");
  layout.spacing_m = spacing->is_number() ? spacing->get<double>() : std::numeric_limits<double>::quiet_NaN();
  RAYFIELD_CHECK(get_rows(arrays, layout));
  RAYFIELD_CHECK(get_panels(arrays, layout));
  RAYFIELD_CHECK(get_posts(arrays, layout));
  RAYFIELD_CHECK(get_trunks(arrays, layout));
  return layout;
}

}  // namespace rayfield::density
