#include <stdlib.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "libtile/tile_file/tile_file.h"
#include "rayfield/core/sha256.h"
#include "rayfield/tile/store.h"
#include "tests/fuzz/memory_file.h"
#include "tests/libtile/hdf5/resealed.h"

namespace {

using namespace rayfield::tile;

/// A store without scans: its tiles are given by absolute paths.
class StoreFolder {
 public:
  StoreFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rayfield-fuzz-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
    StoreConfig config;
    config.crs = "EPSG:7854";
    if (!Store::create(folder_ / "block", config)) std::abort();
  }
  StoreFolder(const StoreFolder&) = delete;
  StoreFolder& operator=(const StoreFolder&) = delete;
  ~StoreFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Store open() const { return Store::open(folder_ / "block").value(); }

 private:
  std::filesystem::path folder_;
};

}  // namespace

/// Whatever the HDF5 image of a tile, sealed by whoever made it: an error, or as many segments as it says, with
/// coordinates that are finite.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayfield::fuzz::MemoryFile kFile;
  static const StoreFolder kFolder;
  static const Store kStore = kFolder.open();
  const std::vector<std::byte> file = testing::resealed(std::as_bytes(std::span(data, size)));
  kFile.set(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
  const auto part = read_tile_part(kFile.path());
  if (!part) return 0;
  TileEntry tile;
  tile.index = part->header.index;
  tile.file = {kFile.path(), file.size(), rayfield::sha256_hex(file)};
  tile.segment_count = part->header.segments;
  const auto reader = kStore.open_tile(tile);
  if (!reader) return 0;
  SegmentBatch segments;
  std::uint64_t count = 0;
  for (std::size_t chunk = 0; chunk < reader->chunk_count(); ++chunk) {
    count += reader->chunk_size(chunk);
    if (!reader->read_chunk(chunk, segments)) continue;
    if (segments.size() != reader->chunk_size(chunk)) std::abort();
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (!segments.entry[i].allFinite() || !segments.exit[i].allFinite() || !std::isfinite(segments.time_s[i]))
        std::abort();
    }
  }
  if (count != tile.segment_count) std::abort();
  return 0;
}
