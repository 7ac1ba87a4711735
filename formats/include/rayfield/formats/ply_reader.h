#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

struct PlyReadOptions {
  /// A file that ends before the rays that its header announces: false refuses it and says how many complete rays
  /// there are; true reads those and warns.
  bool allow_truncated = false;
  /// Bytes behind the last ray: false refuses them, true leaves them out and warns.
  bool allow_trailing = false;
  /// Asked every megabyte; true ends read() with ErrorCode::interrupted. A file may hold nothing but rays that are
  /// dropped, so that a read takes as long as the file.
  std::function<bool()> cancelled = nullptr;
};

/// Reads ray clouds in the PLY layout of raycloudtools (docs/ray-cloud-ply.md) as a stream.
/// Rays with NaN or infinite values, with coordinates beyond ±1e8 m, or of zero length are dropped and counted in
/// warnings().
class PlyReader : public RaySource {
 public:
  /// Reads and checks the header and compares the size of the file with it.
  /// Errors: bad_input (not a PLY; ASCII or big-endian; no ray starts, i.e. a point cloud; no time; truncated or
  /// over-long unless allowed), resources.
  static Result<std::unique_ptr<PlyReader>> open(const std::string& path, const PlyReadOptions& options = {});
  ~PlyReader() override;

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override;
  Result<bool> rewind() override;
  /// Rays in the file, those that will be dropped included.
  std::optional<std::uint64_t> ray_count() const override;
  std::string name() const override;
  std::vector<std::string> warnings() const override;

  /// The CRS that a `comment crs …` line names, as rayfield writes it; raycloudtools names none.
  std::optional<std::string> crs() const;
  /// The lidar's beam from a `comment beam …` line.
  std::optional<LidarBeam> beam() const;

 private:
  struct Impl;
  explicit PlyReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
