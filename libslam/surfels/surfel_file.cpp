#include "libslam/surfels/surfel_file.h"

#include <algorithm>

namespace rayfield::slam {
namespace {

constexpr std::size_t kPiece = std::size_t{64} << 10;  // surfels

}  // namespace

SurfelRecord record_of(const Surfel& s) {
  SurfelRecord r;
  r.time_s = s.time_s;
  std::copy_n(s.center.data(), 3, r.center);
  std::copy_n(s.normal.data(), 3, r.normal);
  r.variance_m2 = s.variance_m2, r.spin_rate_rad_s = s.spin_rate_rad_s, r.level = s.level;
  return r;
}

Surfel surfel_of(const SurfelRecord& r) {
  Surfel s;
  s.time_s = r.time_s;
  s.center = Eigen::Vector3f(r.center[0], r.center[1], r.center[2]);
  s.normal = Eigen::Vector3f(r.normal[0], r.normal[1], r.normal[2]);
  s.variance_m2 = r.variance_m2, s.spin_rate_rad_s = r.spin_rate_rad_s, s.level = r.level;
  return s;
}

Result<void> SurfelFile::append(std::span<const Surfel> surfels) {
  for (const Surfel& s : surfels) newest_.push_back(record_of(s));
  size_ += surfels.size();
  if (newest_.size() < kPiece) return {};
  RAYFIELD_ASSIGN(const SpillFile::Extent extent, spill_->append(std::as_bytes(std::span(newest_))));
  extents_.push_back(extent);
  newest_.clear();
  return {};
}

Result<void> SurfelFile::for_each(const std::function<Result<void>(std::span<const Surfel>)>& consume) const {
  std::vector<SurfelRecord> records;
  std::vector<Surfel> surfels;
  const auto pass_on = [&](std::span<const SurfelRecord> piece) {
    surfels.clear();
    for (const SurfelRecord& r : piece) surfels.push_back(surfel_of(r));
    return consume(surfels);
  };
  for (const SpillFile::Extent& extent : extents_) {
    records.resize(extent.size / sizeof(SurfelRecord));
    RAYFIELD_CHECK(spill_->read(extent, std::as_writable_bytes(std::span(records))));
    RAYFIELD_CHECK(pass_on(records));
  }
  return pass_on(newest_);
}

}  // namespace rayfield::slam
