#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/ray.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

struct PlyWriteOptions {
  /// Named in the header as `comment crs …` where given, e.g. "EPSG:7854".
  std::string crs;
  /// Of the lidar; named in the header as `comment beam …` where given.
  std::optional<LidarBeam> beam = {};
  Result<void> validate() const;
};

/// Writes ray clouds in the PLY layout of raycloudtools: coordinates as double, origin minus end as float, 48 bytes a
/// ray. Alpha holds the intensity, 1 … 255 for a hit (larger ones saturate, 0 becomes 1) and 0 for a ray without one;
/// red, green and blue repeat it as grey. The file appears under its name only after close().
class PlyWriter {
 public:
  static Result<PlyWriter> create(const std::string& path, const PlyWriteOptions& options = {});
  PlyWriter(PlyWriter&&) noexcept;
  PlyWriter& operator=(PlyWriter&&) noexcept;
  ~PlyWriter();

  /// Errors: bad_input for a ray with NaN or infinite values, resources.
  Result<void> write(const RayBatch& batch);
  /// Puts the number of rays into the header, syncs and renames. Nothing can be written afterwards.
  Result<void> close();
  std::uint64_t ray_count() const;

 private:
  struct Impl;
  explicit PlyWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
