#include <cmath>

#include "rayfield/formats/ply_reader.h"
#include "tests/fuzz/memory_file.h"

/// Whatever the bytes: an error, or rays that are finite and not more than announced.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayfield::fuzz::MemoryFile kFile;
  kFile.set(data, size);
  rayfield::formats::PlyReadOptions options;
  options.allow_truncated = true;
  options.allow_trailing = true;
  const auto reader = rayfield::formats::PlyReader::open(kFile.path(), options);
  if (!reader) return 0;
  rayfield::RayBatch batch;
  std::uint64_t rays = 0;
  for (;;) {
    const auto count = (*reader)->read(batch, 1000);
    if (!count || *count == 0) break;
    rays += *count;
    for (std::size_t i = 0; i < *count; ++i) {
      if (!batch.origin[i].allFinite() || !batch.end[i].allFinite() || !std::isfinite(batch.time_s[i])) std::abort();
    }
  }
  if (rays > (*reader)->ray_count().value_or(0)) std::abort();
  return 0;
}
