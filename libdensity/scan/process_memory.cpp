#include "libdensity/scan/process_memory.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "rayfield/core/parallel.h"

namespace rayfield::density {
namespace {

std::uint64_t for_data(const ProcessOptions& options) {
  return options.memory_bytes - std::min(options.memory_bytes, ProcessMemory::kProgram);
}

double mebibytes(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

}  // namespace

ProcessMemory::ProcessMemory(const ProcessOptions& options) {
  const std::uint64_t data = for_data(options);
  surveys_bytes = data / 4;
  canopy_bytes = counts_bytes = data / 2;
  rows_bytes = data / 8 * 5;
  tiles_bytes = maps_bytes = data / 8;
  threads = static_cast<int>(
      std::clamp<std::uint64_t>(data / 4 / kPerThread, 1, static_cast<std::uint64_t>(thread_count(options.threads))));
}

Result<void> check_room(std::size_t share, std::size_t bytes, const ProcessOptions& options, const std::string& where,
                        const std::string& what) {
  if (bytes <= share) return {};
  const double part = static_cast<double>(share) / static_cast<double>(std::max<std::uint64_t>(for_data(options), 1));
  const double needed_mib = mebibytes(ProcessMemory::kProgram) + mebibytes(bytes) / part;
  return fail(
      ErrorCode::resources, "cannot process the scan", where,
      fmt::format("{} {:.0f} MiB, and --memory leaves {:.0f} MiB for that", what, mebibytes(bytes), mebibytes(share)),
      fmt::format("give --memory {:.0f}M or more", std::ceil(needed_mib) + 1));
}

Result<int> workers_within(std::size_t share, std::size_t bytes, int threads, const ProcessOptions& options,
                           const std::string& where) {
  RAYFIELD_CHECK(check_room(share, bytes, options, where, "its voxels take"));
  return static_cast<int>(
      std::clamp<std::size_t>(share / std::max<std::size_t>(bytes, 1), 1, static_cast<std::size_t>(threads)));
}

}  // namespace rayfield::density
