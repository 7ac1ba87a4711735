#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "rayfield/formats/rates_file.h"
#include "tests/fuzz/memory_file.h"

/// Whatever the bytes: an error, or one sensible rate for each zone.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayfield::fuzz::MemoryFile kFile;
  static const std::vector<rayfield::ManagementZone> kZones = [] {
    std::vector<rayfield::ManagementZone> made(3);
    for (int i = 0; i < 3; ++i) made[static_cast<std::size_t>(i)].zone = i + 1;
    return made;
  }();
  kFile.set(data, size);
  const auto rates = rayfield::formats::read_rates(kFile.path(), "l/ha", "Copper", kZones);
  if (!rates) return 0;
  if (rates->rates.size() != kZones.size()) std::abort();
  for (const double rate : rates->rates)
    if (!std::isfinite(rate) || rate < 0) std::abort();
  return 0;
}
