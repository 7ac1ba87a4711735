#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// A product that is written but not yet published.
struct ProductFile {
  std::string name;  ///< within the folder
  std::uint64_t size = 0;
  std::string sha256;
};

/// Products that belong together appear in their folder together. They are written to a private folder within the
/// target and renamed into place when all are complete: a failure before that leaves the folder unchanged. What a
/// killed writer left behind is removed by the next one.
class ProductFolder {
 public:
  /// `last`: the file that is renamed after all others; if it is new, so are all of them.
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
