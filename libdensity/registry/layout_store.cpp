#include "libdensity/registry/layout_store.h"

#include <exception>

#include "libdensity/registry/identity.h"
#include "libdensity/registry/layout_arrays.h"
#include "libdensity/tiles/derive.h"
#include "libdensity/tiles/stored.h"
#include "rayfield/tile/whole_number.h"

namespace rayfield::density {
namespace {

constexpr int kLayoutVersion = 2;

Result<BlockLayout> from_entry(const tile::Store& store, const tile::DerivedEntry& entry) {
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
  BlockLayout block;
  RAYFIELD_ASSIGN(block.layout, layout_from_arrays(arrays));
  name_by_place(block.layout, store.config().crs);
  block.known = true;
  block.key = entry.file.sha256;
  return block;
}

}  // namespace

const tile::DerivedEntry* find_entry(const std::vector<tile::DerivedEntry>& entries, std::string_view kind,
                                     std::string_view name) {
  for (const tile::DerivedEntry& entry : entries)
    if (entry.kind == kind && (name.empty() || entry.name == name)) return &entry;
  return nullptr;
}

std::string layout_name(const ProcessOptions& options, const std::string& survey_key) {
  KeyBuilder key("layout", kLayoutVersion);
  key.add(option_numbers(options.survey));
  key.add(option_numbers(options.ground));
  key.add(option_numbers(options.canopy));
  key.add(option_numbers(options.rows));
  key.add(option_numbers(options.posts));
  if (!survey_key.empty()) key.add(survey_key);
  return key.hex().substr(0, 16);
}

Result<BlockLayout> read_unnamed(const tile::Store& store, const tile::Snapshot& snapshot, std::string_view kind) {
  const tile::DerivedEntry* entry = find_entry(snapshot.registry, kind);
  if (entry == nullptr) return BlockLayout{};
  return from_entry(store, *entry);
}

Result<BlockLayout> read_layout(const tile::Store& store, const tile::Snapshot& snapshot) {
  RAYFIELD_ASSIGN(BlockLayout block, read_unnamed(store, snapshot, kRowsKind));
  RAYFIELD_ASSIGN(const StoredNames names, read_stored_names(store, snapshot));
  apply_names(names, block.layout);
  return block;
}

Result<BlockLayout> read_survey(const tile::Store& store, const tile::Snapshot& snapshot) {
  RAYFIELD_ASSIGN(BlockLayout block, read_unnamed(store, snapshot, kSurveyKind));
  RAYFIELD_ASSIGN(const StoredNames names, read_stored_names(store, snapshot));
  apply_names(names, block.layout);
  return block;
}

Result<BlockLayout> read_found(const tile::Store& store, const tile::Snapshot& snapshot, const std::string& name) {
  // Stores made before layouts learned have the layout of today only: what was found.
  const tile::DerivedEntry* entry = find_entry(snapshot.registry, kFoundKind, name);
  if (entry == nullptr) entry = find_entry(snapshot.registry, kRowsKind, name);
  if (entry == nullptr) return BlockLayout{};
  return from_entry(store, *entry);
}

Result<StoredNames> read_stored_names(const tile::Store& store, const tile::Snapshot& snapshot) {
  StoredNames names;
  const tile::DerivedEntry* entry = find_entry(snapshot.registry, kNamesKind, kNamesName);
  if (entry == nullptr) return names;
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(*entry));
  RAYFIELD_ASSIGN(const nlohmann::json json, stored_attributes(arrays, kNamesKind, 1));
  try {
    names.block = {json.at("block").get<std::string>(), json.at("farm").get<std::string>(),
                   json.at("variety").get<std::string>()};
    for (const auto& [uid, row] : json.at("rows").items())
      names.rows[uid] = {tile::whole_number<int>(row.at("number")), row.at("name").get<std::string>()};
  } catch (const std::exception& e) {
    return damaged(arrays, std::string("its attributes are not what they should be: ") + e.what());
  }
  return names;
}

tile::ArraySet names_to_arrays(const StoredNames& names) {
  nlohmann::json json{{"block", names.block.block}, {"farm", names.block.farm}, {"variety", names.block.variety}};
  json["rows"] = nlohmann::json::object();
  for (const auto& [uid, row] : names.rows) json["rows"][uid] = {{"number", row.number}, {"name", row.name}};
  tile::ArraySet arrays;
  arrays.kind = kNamesKind;
  arrays.attributes = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return arrays;
}

void apply_names(const StoredNames& names, RowLayout& layout) {
  for (Row& row : layout.rows) {
    const auto given = names.rows.find(row.identity.uid);
    if (given == names.rows.end()) continue;
    if (given->second.number > 0) row.farm_number = given->second.number;
    if (!given->second.name.empty()) row.name = given->second.name;
  }
}

}  // namespace rayfield::density
