#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "rayfield/formats/trajectory_file.h"
#include "tests/fuzz/memory_file.h"

/// Whatever the bytes, text or packed: an error, or poses whose times increase and that survive being packed and read
/// again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayfield::fuzz::MemoryFile kFile;
  kFile.set(data, size);
  const auto trajectory = rayfield::formats::read_trajectory(kFile.path());
  if (!trajectory) return 0;
  for (std::size_t i = 1; i < trajectory->poses.size(); ++i)
    if (!(trajectory->poses[i - 1].time_s < trajectory->poses[i].time_s)) std::abort();
  const auto packed = rayfield::formats::pack_trajectory(*trajectory);
  if (!packed) return 0;  // e.g. times that are equal to the microsecond
  kFile.set(reinterpret_cast<const std::uint8_t*>(packed->data()), packed->size());
  const auto again = rayfield::formats::read_trajectory(kFile.path());
  if (!again || again->poses.size() != trajectory->poses.size()) std::abort();
  return 0;
}
