#include "cli/drives/drive_picture.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "rayfield/core/date.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {

Result<void> write_drive_picture(const RegisteredDrive& drive, const Grid2<std::uint32_t>& hits,
                                 const std::string& path) {
  RasterProduct density{
      "point_density", "log10(points/m2)", "Lidar hits per area",
      Grid2<float>(hits.origin, hits.cell_m, hits.nx, hits.ny, std::numeric_limits<float>::quiet_NaN())};
  const double cell_area = hits.cell_m * hits.cell_m;
  for (std::size_t i = 0; i < hits.values.size(); ++i)
    if (hits.values[i] > 0) density.grid.values[i] = static_cast<float>(std::log10(hits.values[i] / cell_area));

  formats::PlanOverlay overlay;
  const formats::StrokeStyle track{{20, 60, 160, 255}, 2, 0}, fix{{40, 40, 40, 255}, 1, 0},
      refused{{200, 30, 30, 255}, 1, 0};
  formats::PlanLine line{{}, track, false};
  const std::vector<TimedPose>& poses = drive.trajectory->poses;
  for (std::size_t i = 0; i < poses.size(); i += 10)
    line.points.emplace_back(poses[i].map_from_body.translation.head<2>());
  overlay.lines.push_back(std::move(line));
  for (std::size_t i = 0; i < drive.gps.size(); i += 5)
    overlay.markers.push_back({drive.gps[i].position.head<2>(), drive.gps[i].outlier ? refused.color : fix.color, 1.5});
  overlay.keys = {{track, "trajectory"}, {fix, "GPS fixes"}, {refused, "GPS fixes refused"}};

  formats::PictureOptions options;
  options.title = "Drive";
  options.subtitle = fmt::format("{} – {}, {:.0f} m", utc_text(poses.front().time_s), utc_text(poses.back().time_s),
                                 drive.trajectory->length_m());
  options.scale = formats::ColorScale{0, 5, formats::Ramp::canopy};
  options.legend = "Hits per m², log10";
  return formats::write_plan_picture(density, overlay, path, options);
}

}  // namespace rayfield::cli
