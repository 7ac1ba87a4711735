#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

/// The HDF5 container of tile files and derived files (docs/store-format.md, "HDF5 files"): columns that are already
/// compressed go in, places of compressed chunks come out. All calls into HDF5 are behind one lock of ours, which
/// holds no compression and no file data.
///
///   /attributes        one JSON text
///   /columns/<name>    1-D, chunked, Blosc filter
///   seal               80 bytes after the HDF5 image: "RAYFIELD-SHA256 " and the hex digest of all bytes before it
///
/// The seal keeps damaged bytes away from the HDF5 library, which does not survive all of them.
namespace rayfield::tile {

enum class ElementType : std::uint8_t { u8, u16, i32, u32, i64, u64, f32, f64 };
std::size_t element_size(ElementType type);

/// A column to write; chunk c holds elements [c·chunk_elements, …), the last one padded to chunk_elements.
struct ImageColumn {
  std::string name;
  ElementType type = ElementType::u8;
  std::uint64_t count = 0;
  std::uint64_t chunk_elements = 1;  ///< ≤ count unless count == 0
  std::vector<std::span<const std::byte>> chunks;
};

/// Sealed file content. Chunks stand in the file chunk after chunk, and within a chunk column after column.
Result<std::vector<std::byte>> build_image(const std::string& attributes, const std::vector<ImageColumn>& columns);

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

/// True where the last bytes are a seal that fits the bytes before it.
bool is_sealed(std::span<const std::byte> image);

}  // namespace rayfield::tile
