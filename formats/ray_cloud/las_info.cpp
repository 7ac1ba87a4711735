#include "rayfield/formats/las_info.h"

#include <algorithm>
#include <limits>

#include "formats/las/gps_time.h"
#include "formats/las/las_file.h"
#include "formats/las/point_filter.h"

namespace rayfield::formats {
namespace {

// Points of one block.
void look_at(std::span<const std::byte> records, const LasHeader& header, PointFilter& filter, LasInfo& info) {
  for (std::size_t at = 0; at < records.size(); at += header.point_bytes) {
    const LasPoint point = decode_las_point(&records[at], header);
    if (!filter.takes(point)) continue;
    const bool is_first = info.first_returns == 0;
    info.first_s = is_first ? point.gps_time_s : std::min(info.first_s, point.gps_time_s);
    info.last_s = is_first ? point.gps_time_s : std::max(info.last_s, point.gps_time_s);
    info.low = is_first ? point.position : Eigen::Vector3d(info.low.cwiseMin(point.position));
    info.high = is_first ? point.position : Eigen::Vector3d(info.high.cwiseMax(point.position));
    ++info.first_returns;
  }
}

}  // namespace

Result<LasInfo> inspect_las(const std::string& path, const std::function<bool()>& cancelled,
                            const std::function<void(std::uint64_t)>& advance) {
  RAYFIELD_ASSIGN(LasFile file, LasFile::open(path, {.allow_truncated = true, .allow_trailing = true}));
  const LasHeader& header = file.header();
  LasInfo info;
  info.minor_version = header.minor_version, info.point_format = header.point_format;
  info.adjusted_gps_time = header.says_adjusted_gps_time();
  info.crs = file.crs().text, info.crs_name = file.crs().name;
  info.points = file.point_count();
  PointFilter filter;
  for (std::uint64_t next = 0; next < info.points;) {
    if (cancelled && cancelled())
      return fail(ErrorCode::interrupted, "interrupted", path, "", "run the same command again");
    RAYFIELD_ASSIGN(const auto records, file.records(next, info.points - next));
    look_at(records, header, filter, info);
    const std::uint64_t count = records.size() / header.point_bytes;
    next += count;
    if (advance) advance(count);
  }
  if (info.adjusted_gps_time && info.first_returns > 0)
    info.start_unix_s = unix_time_of_adjusted(info.first_s), info.end_unix_s = unix_time_of_adjusted(info.last_s);
  info.later_returns = filter.later_returns, info.not_finite = filter.not_finite;
  info.withheld = filter.withheld, info.synthetic = filter.synthetic, info.noise = filter.noise;
  info.problems = file.notes();
  return info;
}

}  // namespace rayfield::formats
