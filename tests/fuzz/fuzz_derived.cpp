#include <cstdint>
#include <cstdlib>

#include "libdensity/ground/ground_arrays.h"
#include "libdensity/ground/survey_arrays.h"
#include "libdensity/learning/scan_evidence.h"
#include "libdensity/registry/layout_arrays.h"
#include "libdensity/results/results_io.h"
#include "libdensity/voxels/canopy_profile_arrays.h"
#include "libdensity/voxels/row_segment_arrays.h"
#include "libdensity/voxels/voxel_arrays.h"
#include "tests/fuzz/array_bytes.h"

namespace {

using namespace rayfield;
using namespace rayfield::density;

/// An error, or something that is stored and read again as it is.
template <class Read, class Write>
void check(const tile::ArraySet& arrays, Read read, Write write) {
  const auto value = read(arrays);
  if (!value) return;
  const tile::ArraySet stored = write(*value);
  const auto again = read(stored);
  // NaNs are not equal to themselves: bytes are compared.
  if (!again || fuzz::pack(write(*again)) != fuzz::pack(stored)) std::abort();
}

std::uint64_t size_of(const tile::ArraySet& arrays, const char* column) {
  const auto found = arrays.columns.find(column);
  return found == arrays.columns.end() ? 0 : std::visit([](const auto& v) { return v.size(); }, found->second);
}

}  // namespace

/// Derived data of a store, sealed by whoever made it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tile::ArraySet arrays = fuzz::Unpacker(std::span(data, size)).read();
  check(arrays, survey_from_arrays, survey_to_arrays);
  check(arrays, ground_from_arrays, [](const auto& ground) { return ground_to_arrays(ground.first, ground.second); });
  check(arrays, profile_from_arrays, profile_to_arrays);
  check(arrays, voxels_from_arrays, arrays_from_voxels);
  check(arrays, row_segments_from_arrays, row_segments_to_arrays);
  check(arrays, evidence_from_arrays, evidence_to_arrays);
  check(arrays, layout_from_arrays, [&](const RowLayout& layout) { return layout_to_arrays(layout, arrays.kind); });
  static_cast<void>(results_from_arrays(arrays, {}, {}));
  static_cast<void>(sections_of(arrays, size_of(arrays, kSectionValues)));
  static_cast<void>(raster_of(arrays, size_of(arrays, kRasterValues)));
  return 0;
}
