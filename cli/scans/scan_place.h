#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/ray_source.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// Looks at the first rays of a cloud before any is taken into the store: whether the store's CRS is made for their
/// place, and whether the block's other scans lie there too. `replaced`: the id of a scan that this one takes the place
/// of. A warning, or nothing. Errors: bad_input, naming the cloud; what reading gives.
Result<std::optional<std::string>> check_scan_place(RaySource& cloud, const std::string& crs,
                                                    const tile::Snapshot& latest, const std::string& replaced);

/// Passes rays on, counts those that begin more than 5 km from the block's other scans (without any: from where the
/// scan begins), and warns of them with the rest. check_scan_place() looks at the first rays only.
class PlacedSource : public RaySource {
 public:
  /// `source` must outlive this object. `latest`, `replaced`: as of check_scan_place().
  PlacedSource(RaySource& source, const tile::Snapshot& latest, const std::string& replaced);

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override;
  Result<bool> rewind() override;
  std::optional<std::uint64_t> ray_count() const override { return source_.ray_count(); }
  std::string name() const override { return source_.name(); }
  std::vector<std::string> warnings() const override;

 private:
  RaySource& source_;
  std::vector<Eigen::AlignedBox2d> block_;  // where the other scans began, or the first ray does
  bool has_scans_;
  std::uint64_t rays_ = 0, far_rays_ = 0;
  double farthest_m_ = 0;
};

}  // namespace rayfield::cli
