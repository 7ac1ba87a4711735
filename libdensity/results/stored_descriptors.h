#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

/// Canopy descriptors as columns of stored arrays, in one place for writing and reading.
namespace rayfield::density {

using StoredDescriptor = std::pair<const char*, double CanopyDescriptors::*>;

/// Those of leaves and wood together.
inline constexpr std::array<StoredDescriptor, 3> kPlantDescriptors{{
    {"canopy_base_m", &CanopyDescriptors::canopy_base_m},
    {"row_gap_share", &CanopyDescriptors::row_gap_share},
    {"porosity", &CanopyDescriptors::porosity},
}};
/// Those of what leaf_area_m2 is of.
inline constexpr std::array<StoredDescriptor, 4> kLeafDescriptors{{
    {"leaf_layer_number", &CanopyDescriptors::leaf_layer_number},
    {"exposed_leaf_share", &CanopyDescriptors::exposed_leaf_share},
    {"fruit_zone_area_per_m", &CanopyDescriptors::fruit_zone_area_per_m},
    {"fruit_zone_density", &CanopyDescriptors::fruit_zone_density},
}};

/// Columns <prefix><name> of `values`, which are PanelValue or RowMetreProduct.
template <class Columns, class Value>
void put_descriptors(const Columns& columns, const std::string& prefix, const std::vector<Value>& values,
                     tile::ArraySet& arrays) {
  for (const auto& [name, member] : columns) {
    std::vector<double> column;
    for (const Value& value : values) column.push_back(value.descriptors.*member);
    arrays.columns[prefix + name] = std::move(column);
  }
}

/// The other way. Results of earlier versions have no such columns: then descriptors are undefined. `at(i)`: the value
/// of the columns' row i. Errors: damaged.
template <class Columns, class At>
Result<void> take_descriptors(const Columns& columns, const std::string& prefix, const tile::ArraySet& arrays,
                              std::size_t count, const At& at) {
  for (const auto& [name, member] : columns) {
    for (std::size_t i = 0; i < count; ++i) at(i).descriptors.*member = CanopyDescriptors::kUndefined;
    if (!arrays.columns.contains(prefix + name)) continue;
    RAYFIELD_ASSIGN(const auto column, arrays.column<double>(prefix + name));
    if (column.size() != count)
      return fail(ErrorCode::damaged, "cannot read derived data", prefix + name, "columns differ in length",
                  "run `rayfield verify`");
    for (std::size_t i = 0; i < count; ++i) at(i).descriptors.*member = column[i];
  }
  return {};
}

}  // namespace rayfield::density
