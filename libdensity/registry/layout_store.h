#pragma once
/// registry: identities that last from scan to scan, surveyed rows, and the layout as the store keeps it.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "rayfield/density/options.h"
#include "rayfield/density/registry.h"
#include "rayfield/tile/store.h"

/// The registry's files in a snapshot (docs/store-format.md): "survey" as imported; "found", what the layout starts
/// from: found in the first scan, or the survey completed by it; "rows", the layout of today, with what later scans
/// have taught; "names", what the user calls things.
namespace rayfield::density {

inline constexpr const char* kSurveyKind = "survey";
inline constexpr const char* kFoundKind = "found";
inline constexpr const char* kRowsKind = "rows";
inline constexpr const char* kNamesKind = "names";
inline constexpr const char* kNamesName = "block";
inline constexpr const char* kSurveyName = "surveyed";

/// The block's layout as the store's registry has it, with names.
struct BlockLayout {
  bool known = false;
  RowLayout layout;
  std::string key;  ///< SHA-256 of the file it was read from
};

/// The layout of today that the snapshot holds, whatever it was found with.
Result<BlockLayout> read_layout(const tile::Store& store, const tile::Snapshot& snapshot);

/// The survey in the snapshot, if there is one.
Result<BlockLayout> read_survey(const tile::Store& store, const tile::Snapshot& snapshot);

/// Either of them as stored, before the user's names: what files are made of.
Result<BlockLayout> read_unnamed(const tile::Store& store, const tile::Snapshot& snapshot, std::string_view kind);

/// Names of the files of a layout found with these options, and within this survey: a layout of other parameters is
/// told apart without reading it.
std::string layout_name(const ProcessOptions& options, const std::string& survey_key);

/// What the layout of these options starts from; not known when the snapshot has none.
Result<BlockLayout> read_found(const tile::Store& store, const tile::Snapshot& snapshot, const std::string& name);

const tile::DerivedEntry* find_entry(const std::vector<tile::DerivedEntry>& entries, std::string_view kind,
                                     std::string_view name = {});

/// Names as stored: the block's, and rows' by their UUIDs.
struct StoredNames {
  struct OfRow {
    int number = 0;  ///< 0: none given
    std::string name;
  };
  BlockNames block;
  std::map<std::string, OfRow> rows;  ///< by row_uid
};
Result<StoredNames> read_stored_names(const tile::Store& store, const tile::Snapshot& snapshot);
tile::ArraySet names_to_arrays(const StoredNames& names);
/// Gives rows the numbers and names that the user gave them.
void apply_names(const StoredNames& names, RowLayout& layout);

}  // namespace rayfield::density
