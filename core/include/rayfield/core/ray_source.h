#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/ray.h"
#include "rayfield/core/result.h"

namespace rayfield {

/// A stream of rays in the order in which they were measured. Readers (PLY, LAS, SLAM output, simulation) implement
/// it; the tile store consumes it in batches, so no reader ever holds a whole cloud.
class RaySource {
 public:
  virtual ~RaySource() = default;

  /// Replaces the content of `batch` by the next rays, at most `max_rays`; 0 means the end of the stream.
  virtual Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) = 0;

  /// Goes back to the first ray. A source that cannot be read twice returns false and stays where it is.
  virtual Result<bool> rewind() = 0;

  /// Number of rays in the whole stream, if known in advance.
  virtual std::optional<std::uint64_t> ray_count() const { return std::nullopt; }

  /// Path or name for messages and provenance.
  virtual std::string name() const = 0;

  /// What was left out so far and why, one line each with counts ("12 rays with NaN coordinates dropped").
  virtual std::vector<std::string> warnings() const { return {}; }
};

}  // namespace rayfield
