#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/surveyed_block.h"
#include "rayfield/tile/store.h"

/// The registry of a block: rows, panels and posts with what they are called (docs/registry.md).
namespace rayfield::density {

/// What the user calls the block. Without a name of its own it has that of the store's folder.
struct BlockNames {
  std::string block, farm, variety;
};
Result<BlockNames> read_names(const tile::Store& store, const tile::Snapshot& snapshot);

/// Rows, panels and posts with names and dates, without scans; heights of the ground are NaN. Empty where there is no
/// layout yet. Errors: damaged.
Result<BlockProducts> read_registry(const tile::Store& store, const tile::Snapshot& snapshot);

/// What shall be called otherwise. Rows go by the number that they are shown with.
struct Renaming {
  std::optional<std::string> block, farm, variety;
  std::map<int, std::string> rows;  ///< a whole number: the farm's number; anything else: the row's name
};

/// Names and numbers change, nothing else: no value is computed again. Errors: usage (unknown row, a number or name
/// that another row has, a text that cannot be a name), damaged, resources, locked.
Result<void> rename(tile::Store& store, const Renaming& renaming, const std::string& command);

/// What taking in a survey did.
struct ImportReport {
  std::size_t rows = 0, posts = 0;
  std::size_t rows_matched = 0, posts_matched = 0;  ///< stand where the registry had one: identities are kept
  bool geometry_changed = false;                    ///< the next process() makes the maps anew
};

/// Makes a survey the block's reference. Rows and posts within 5 cm of what the registry has bring their names and
/// numbers and leave the geometry alone; otherwise the survey rules, and what stands at the same place keeps its
/// identity. Errors: bad_input (the survey does not do, or lies away from the store's scans), damaged, resources,
/// locked.
Result<ImportReport> import_reference(tile::Store& store, const SurveyedBlock& survey, const std::string& command);

/// Whether a survey does, by itself. Errors: bad_input.
Result<void> check_survey(const SurveyedBlock& survey);

/// What import_reference() would do, without doing it.
Result<ImportReport> preview_reference(const tile::Store& store, const SurveyedBlock& survey);

}  // namespace rayfield::density
