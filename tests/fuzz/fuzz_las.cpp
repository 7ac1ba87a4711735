#include <cmath>
#include <memory>

#include "rayfield/formats/las_info.h"
#include "rayfield/formats/las_reader.h"
#include "tests/fuzz/memory_file.h"

namespace {

// A minute from 2021-07-01T00:00:00Z, with a gap, where the points of the seeds were measured.
std::shared_ptr<const rayfield::formats::TrajectoryFile> make_drive() {
  auto drive = std::make_shared<rayfield::formats::TrajectoryFile>();
  for (int i = 0; i < 600; ++i)
    if (i < 200 || i > 250)
      drive->poses.push_back({1625097600 + 0.1 * i, {Eigen::Quaterniond::Identity(), {276000 + 0.1 * i, 6099000, 82}}});
  return drive;
}

}  // namespace

/// Whatever the bytes: an error, or hits that are finite, near the trajectory, and not more than announced.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayfield::fuzz::MemoryFile kFile;
  static const auto kDrive = make_drive();
  kFile.set(data, size);
  const auto info = rayfield::formats::inspect_las(kFile.path(), {}, {});
  rayfield::formats::LasReadOptions options;
  options.allow_truncated = true;
  options.allow_trailing = true;
  options.lever_arm_m = {0.1, 0.2, 0.3};
  const auto reader = rayfield::formats::LasReader::open(kFile.path(), kDrive, options);
  if (!reader) return 0;
  if (!info) std::abort();
  rayfield::RayBatch batch;
  std::uint64_t rays = 0;
  for (;;) {
    const auto count = (*reader)->read(batch, 1000);
    if (!count || *count == 0) break;
    rays += *count;
    for (std::size_t i = 0; i < *count; ++i) {
      if (!batch.end[i].allFinite() || !std::isfinite(batch.time_s[i]) || batch.hit[i] == 0) std::abort();
      if (!((batch.origin[i] - kDrive->poses.front().map_from_body.translation).norm() < 100)) std::abort();
    }
  }
  if (rays > info->first_returns) std::abort();
  return 0;
}
