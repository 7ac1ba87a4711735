#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// A product that was written and waits to be published.
struct ProductFile {
  std::string name;  ///< within the folder
  std::uint64_t size = 0;
  std::string sha256;
};

/// Products that belong together appear in their folder together. They are written aside, in a private folder within
/// the target, and renamed into place when all of them are complete: whatever fails before leaves the folder as it was.
/// What a writer that was killed left behind is removed by the next one.
class ProductFolder {
 public:
  /// `last`: the file that is renamed after all others; whoever finds it new finds all of them new.
  /// Errors: bad_input (no such folder), resources.
  static Result<ProductFolder> create(const std::string& folder, const std::string& last, const std::string& what);

  /// Where to write the product of that name.
  std::string path(const std::string& name) const;
  /// What has been written so far, by name.
  Result<std::vector<ProductFile>> files() const;
  /// Syncs everything that was written and moves it into the folder. Statistics that GDAL keeps beside an older raster
  /// (`.aux.xml`) go. Errors: resources (also where a folder has the name of a product; nothing is moved then).
  Result<void> publish() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace rayfield::formats
