#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/formats/rosbag_writer.h"

namespace rayfield::formats {

/// Decompresses a chunk into `out`. `size` is the length that the chunk's header states; memory is taken as data
/// comes out, so that a wrong header cannot ask for much. Errors: bad_input with the reason in `why`.
Result<void> decompress_bag_chunk(std::string_view compression, std::span<const std::byte> data, std::size_t size,
                                  std::vector<std::byte>& out);

/// Compresses a chunk as the ROS libraries do. Errors: internal, resources.
Result<void> compress_bag_chunk(BagCompression compression, std::span<const std::byte> data,
                                std::vector<std::byte>& out);
std::string_view bag_compression_name(BagCompression compression);

}  // namespace rayfield::formats
