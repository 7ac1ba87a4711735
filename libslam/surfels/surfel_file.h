#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "libslam/surfels/surfel.h"
#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"

namespace rayfield::slam {

/// A surfel as it lies on disk.
struct SurfelRecord {
  double time_s = 0;
  float center[3] = {}, normal[3] = {};
  float variance_m2 = 0, spin_rate_rad_s = 0;
  std::uint8_t level = 0;
  bool own = true;  ///< see SurfelRegion
};
SurfelRecord record_of(const Surfel& surfel);
Surfel surfel_of(const SurfelRecord& record);

/// The surfels of a drive in the order of their time bins, on disk but for the newest. Errors: those of SpillFile.
class SurfelFile {
 public:
  SurfelFile() : SurfelFile(std::filesystem::temp_directory_path()) {}
  explicit SurfelFile(const std::filesystem::path& directory) : spill_(std::make_unique<SpillFile>(directory)) {}

  Result<void> append(std::span<const Surfel> surfels);
  std::uint64_t size() const { return size_; }

  /// Calls consume() with all surfels, in order, some tens of thousands at a time.
  Result<void> for_each(const std::function<Result<void>(std::span<const Surfel>)>& consume) const;

 private:
  std::unique_ptr<SpillFile> spill_;
  std::vector<SpillFile::Extent> extents_;
  std::vector<SurfelRecord> newest_;
  std::uint64_t size_ = 0;
};

}  // namespace rayfield::slam
