#pragma once

#include <string>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// The leaf areas of a scan whose wood is known. They are kept beside its results, which hold what its own rays say, so
/// that another dormant scan changes nothing else.
struct LeafValues {
  std::string wood_scan_id;        ///< whose wood was subtracted; the scan itself: it is dormant; empty: by estimate
  std::string wood_content;        ///< names that scan's rays, or begins with kWoodByEstimate
  std::vector<PanelValue> panels;  ///< those of the results, with leaf areas and their errors in place
  std::vector<RowMetreProduct> metres;  ///< those of the results, with leaf areas and descriptors of leaves in place
  std::vector<double> profile;          ///< leaf_area_m2 of the results' bands, in their order
};

/// Stored form, kind "leaf" version 1: panels are named by their numbers, and hold leaf areas and their errors only.
tile::ArraySet leaf_to_arrays(const LeafValues& leaf, const RowLayout& layout);
/// Puts stored leaf areas into the results they were made from, and says whose wood was subtracted. Errors: damaged.
Result<void> put_leaf_values(const tile::ArraySet& arrays, const RowLayout& layout, ScanResults& results);

/// Stands where the rays of a dormant scan are named when there is none.
inline constexpr const char* kWoodByEstimate = "by estimate";

/// Of stored leaf areas: whose wood was subtracted.
struct WoodSource {
  std::string scan_id, content;
  bool operator==(const WoodSource&) const = default;
};
Result<WoodSource> wood_source_of(const tile::ArraySet& arrays);

}  // namespace rayfield::density
