#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/ray_source.h"

namespace rayfield::cli {

/// What to say of a scan that was measured on another day than `date` (YYYY-MM-DD): a line, or nothing. `start_s`,
/// `end_s`: Unix time of its first and last ray. The clock is UTC, the date that of the people on the ground: both days
/// are right, and so is any that civil time, up to three hours off the sun's (longitude / 15° hours after UTC), gives.
/// Times before 2000 are counted from somewhere else and say nothing.
std::optional<std::string> date_warning(const std::string& date, double start_s, double end_s, double longitude_deg);

/// Passes rays on, notes when and where they were measured, and warns with the rest when that is not the scan's date.
class DatedSource : public RaySource {
 public:
  /// `source` must outlive this object. `crs`: of its rays.
  DatedSource(RaySource& source, std::string date, std::string crs)
      : source_(source), date_(std::move(date)), crs_(std::move(crs)) {}

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override;
  Result<bool> rewind() override { return source_.rewind(); }
  std::optional<std::uint64_t> ray_count() const override { return source_.ray_count(); }
  std::string name() const override { return source_.name(); }
  std::vector<std::string> warnings() const override;

 private:
  RaySource& source_;
  std::string date_, crs_;
  double first_s_ = std::numeric_limits<double>::infinity(), last_s_ = -std::numeric_limits<double>::infinity();
  std::optional<Eigen::Vector3d> place_;  // origin of the first ray, in the map
};

}  // namespace rayfield::cli
