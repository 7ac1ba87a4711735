#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::tile {

/// The bytes of a derived file: an HDF5 image (h5_write.h) with the columns compressed and the attributes as one JSON
/// text.
Result<std::vector<std::byte>> encode_arrays(const ArraySet& arrays);
/// `where` is named in errors. Errors: damaged.
Result<ArraySet> decode_arrays(std::span<const std::byte> image, const std::string& where);

}  // namespace rayfield::tile
