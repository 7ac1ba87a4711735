#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libtile/hdf5/h5_dataset.h"
#include "rayfield/core/result.h"

/// Where things lie in a file that build_image() made (h5_write.h). Stores come from strangers, and the HDF5 library
/// does not survive every file: this reads the structures that the writer makes by itself, and refuses all others, in
/// time and memory in proportion to the file (docs/store-format.md, "HDF5 structures").
namespace rayfield::tile {

struct ImageLayout {
  std::string attributes;
  std::vector<ColumnLayout> columns;  ///< ordered by name; no two chunks share a byte
  const ColumnLayout* find(const std::string& name) const;
};

/// Checks the seal, then reads the structure. `where` is named in errors. Errors: damaged.
Result<ImageLayout> read_layout(std::span<const std::byte> image, const std::string& where);
/// The same of a file whose SHA-256 has been checked by the caller.
Result<ImageLayout> read_layout(const std::filesystem::path& checked_file);

}  // namespace rayfield::tile
