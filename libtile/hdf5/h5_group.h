#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libtile/hdf5/h5_bytes.h"
#include "rayfield/core/result.h"

namespace rayfield::tile {

/// A name in a group and the address of the object's header behind it.
struct H5Name {
  std::string name;
  std::uint64_t object = 0;
};

/// The names in the group whose header is at `offset`, in ascending order, `most` at most. Links to elsewhere are
/// refused. Errors: damaged.
Result<std::vector<H5Name>> read_group(H5Bytes& bytes, std::uint64_t offset, std::size_t most);

}  // namespace rayfield::tile
