#pragma once

#include <filesystem>
#include <memory>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Values of a scan's sections on their way into its results. They are megabytes per hectare, and nobody needs them
/// again before the results are written: until then they are in a temporary file.
class SectionValues {
 public:
  /// `folder`: of the temporary file.
  explicit SectionValues(std::filesystem::path folder) : file_(std::make_unique<SpillFile>(std::move(folder))) {}

  /// Takes the values out of the section. Errors: resources.
  Result<void> take(SectionProduct& section);
  /// The values of all sections taken so far, in that order. This object has to outlive it.
  tile::ColumnSource source() const;

 private:
  std::unique_ptr<SpillFile> file_;
};

}  // namespace rayfield::density
