#include <cstdint>
#include <cstdlib>

#include "libtile/hdf5/array_image.h"
#include "tests/libtile/hdf5/resealed.h"

/// Whatever the HDF5 image of a derived file, sealed by whoever made it: an error, or columns that survive being
/// written and read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rayfield::tile;
  const auto arrays = decode_arrays(testing::resealed(std::as_bytes(std::span(data, size))), "fuzz");
  if (!arrays) return 0;
  const auto written = encode_arrays(*arrays);
  if (!written) std::abort();
  const auto again = decode_arrays(*written, "again");
  // NaNs are not equal to themselves: bytes are compared.
  if (!again || *encode_arrays(*again) != *written) std::abort();
  return 0;
}
