#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libtile/hdf5/element_type.h"
#include "rayfield/core/result.h"

/// Where things lie in a file that build_image() made (h5_write.h). Foreign files are refused: links, external storage,
/// other filters and claims beyond the size of the file.
namespace rayfield::tile {

struct ChunkPlace {
  std::uint64_t offset = 0, size = 0;  ///< bytes, in the file
};

struct ColumnLayout {
  std::string name;
  ElementType type = ElementType::u8;
  std::uint64_t count = 0;
  std::uint64_t chunk_elements = 1;
  std::vector<ChunkPlace> chunks;
};

struct ImageLayout {
  std::string attributes;
  std::vector<ColumnLayout> columns;  ///< ordered by name
  const ColumnLayout* find(const std::string& name) const;
};

/// Checks the seal, then reads the structure. `where` is named in errors. Errors: damaged.
Result<ImageLayout> read_layout(std::span<const std::byte> image, const std::string& where);
/// The same of a file whose SHA-256 has been checked by the caller.
Result<ImageLayout> read_layout(const std::filesystem::path& checked_file);

}  // namespace rayfield::tile
