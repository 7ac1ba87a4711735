#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "rayfield/formats/rig_file.h"

/// Whatever the text: an error, or a rig that is valid and survives being written and read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto rig = rayfield::formats::parse_rig({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!rig) return 0;
  const auto again = rayfield::formats::parse_rig(rayfield::formats::rig_text(*rig), "again");
  if (!rayfield::formats::validate_rig(*rig) || !again) std::abort();
  if (again->lidar.topic != rig->lidar.topic || again->lidar.max_range_m != rig->lidar.max_range_m) std::abort();
  return 0;
}
