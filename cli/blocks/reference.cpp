#include "cli/blocks/reference.h"

#include "rayfield/formats/reference_file.h"

namespace rayfield::cli {

Result<density::ImportReport> take_reference(tile::Store& store, const std::string& file, bool dry_run,
                                             const std::string& command) {
  RAYFIELD_ASSIGN(const SurveyedBlock survey, formats::read_reference_file(file, store.config().crs));
  return dry_run ? density::preview_reference(store, survey) : density::import_reference(store, survey, command);
}

}  // namespace rayfield::cli
