#include "libdensity/scan/estimation.h"

#include <array>
#include <cmath>
#include <utility>

#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

constexpr const char* kKind = "estimation";

// Columns of the masked wood, in the order of wood_numbers().
constexpr std::array<const char*, 10> kWoodColumns{"wood_row",      "wood_base_e", "wood_base_n", "wood_base_h",
                                                   "wood_axis_e",   "wood_axis_n", "wood_axis_h", "wood_radius_m",
                                                   "wood_length_m", "wood_bend_m"};
using WoodNumbers = std::array<double, kWoodColumns.size()>;

WoodNumbers wood_numbers(const WoodCylinder& w) {
  return {static_cast<double>(w.row),
          w.base.x(),
          w.base.y(),
          w.base.z(),
          w.axis.x(),
          w.axis.y(),
          w.axis.z(),
          w.radius_m,
          w.length_m,
          w.bend_m};
}

WoodCylinder wood_from(const WoodNumbers& n) {
  return {static_cast<int>(n[0]), {n[1], n[2], n[3]}, {n[4], n[5], n[6]}, n[7], n[8], n[9]};
}

tile::ArraySet to_arrays(const EstimatorOptions& estimator, double wood_shell_m, std::span<const WoodCylinder> wood) {
  tile::ArraySet arrays{.kind = kKind, .attributes = "{}"};
  arrays.columns["estimator"] = option_numbers(estimator);
  arrays.columns["wood_shell_m"] = std::vector<double>{wood_shell_m};
  for (std::size_t k = 0; k < kWoodColumns.size(); ++k) {
    std::vector<double> column;
    for (const WoodCylinder& w : wood) column.push_back(wood_numbers(w)[k]);
    arrays.columns[kWoodColumns[k]] = std::move(column);
  }
  return arrays;
}

Result<std::vector<WoodCylinder>> wood_of_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto rows, arrays.column<double>(kWoodColumns.front()));
  std::vector<WoodNumbers> numbers(rows.size());
  for (std::size_t k = 0; k < kWoodColumns.size(); ++k) {
    RAYFIELD_ASSIGN(const auto column, stored_column<double>(arrays, kWoodColumns[k], rows.size()));
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (!std::isfinite(column[i]) || std::abs(column[i]) > 1e9)
        return damaged(arrays, "masked wood has values that cannot be");
      numbers[i][k] = column[i];
    }
  }
  std::vector<WoodCylinder> wood;
  for (const WoodNumbers& n : numbers) wood.push_back(wood_from(n));
  return wood;
}

}  // namespace

Result<void> keep_estimation(ScanWork& work, std::span<const WoodCylinder> wood) {
  KeyBuilder key(kKind, kEstimationVersion);
  key.add(option_numbers(work.options.estimator)).add(work.voxels.wood_shell_m);
  key.add(static_cast<std::int64_t>(wood.size()));
  for (const WoodCylinder& w : wood) {
    const WoodNumbers numbers = wood_numbers(w);
    key.add(std::vector<double>(numbers.begin(), numbers.end()));
  }
  RAYFIELD_CHECK(work.files.get(kKind, "block", key.hex(), [&]() -> Result<tile::ArraySet> {
    return to_arrays(work.options.estimator, work.voxels.wood_shell_m, wood);
  }));
  return {};
}

Result<Estimation> read_estimation(const tile::Store& store, const tile::ScanEntry& scan) {
  const tile::DerivedEntry* found = nullptr;
  for (const tile::DerivedEntry& entry : scan.derived)
    if (entry.kind == kKind) found = &entry;
  if (found == nullptr)
    return fail(ErrorCode::usage, "no densities of voxels", scan.scan_id,
                "it has not been processed, or by an older version", "run `rayfield process` first");
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(*found));
  Estimation estimation;
  RAYFIELD_ASSIGN(const auto estimator,
                  stored_column<double>(arrays, "estimator", option_numbers(EstimatorOptions{}).size()));
  const auto is_one_of = [&](Estimator choice) { return estimator[0] == static_cast<double>(choice); };
  if (!is_one_of(Estimator::unbiased) && !is_one_of(Estimator::paper))
    return damaged(arrays, "there is no such estimator");
  if (!(std::abs(estimator[2]) <= 1e6)) return damaged(arrays, "paper_min_rays cannot be");
  estimation.estimator = {static_cast<Estimator>(static_cast<int>(estimator[0])), estimator[1],
                          static_cast<int>(estimator[2])};
  if (!estimation.estimator.validate()) return damaged(arrays, "options of the estimator are out of range");
  RAYFIELD_ASSIGN(const auto shell, stored_column<double>(arrays, "wood_shell_m", 1));
  if (!(shell[0] >= 0 && shell[0] < 10)) return damaged(arrays, "wood_shell_m cannot be");
  estimation.wood_shell_m = shell[0];
  RAYFIELD_ASSIGN(estimation.wood, wood_of_arrays(arrays));
  return estimation;
}

}  // namespace rayfield::density
