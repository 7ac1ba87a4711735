#include "rayfield/sim/truth_files.h"

#include <fmt/core.h>

#include <cmath>
#include <span>
#include <string>
#include <system_error>

#include "rayfield/core/file.h"

namespace rayfield::sim {
namespace {

using Text = std::string;

void tum_lines(const std::vector<TimedPose>& poses, Text& out) {
  for (const TimedPose& pose : poses) {
    const Eigen::Vector3d& p = pose.map_from_body.translation;
    const Eigen::Quaterniond& q = pose.map_from_body.rotation;
    out += fmt::format("{:.6f} {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.time_s, p.x(), p.y(), p.z(),
                       q.x(), q.y(), q.z(), q.w());
  }
}

Text trajectory_text(const Truth& truth) {
  Text out = fmt::format(
      "# local east-north-up metres at the site origin (WGS 84 lat {:.9g} lon {:.9g} alt {:.9g}), base=IMU frame; "
      "t tx ty tz qx qy qz qw\n",
      truth.site.latitude_deg, truth.site.longitude_deg, truth.site.height_m);
  tum_lines(truth.trajectory, out);
  return out;
}

Text map_trajectory_text(const Truth& truth) {
  Text out = fmt::format(
      "# {} easting northing height, orientation relative to grid east north up, base=IMU frame; "
      "t tx ty tz qx qy qz qw\n",
      truth.site.crs_code());
  tum_lines(truth.trajectory_in_map, out);
  return out;
}

Text rows_text(const Truth& truth) {
  Text out = "row,e0,n0,e1,n1\n";
  for (const Truth::Row& r : truth.rows)
    out += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g}\n", r.row, r.from.x(), r.from.y(), r.to.x(), r.to.y());
  return out;
}

Text panels_text(const Truth& truth) {
  Text out = "row,panel,e0,n0,e1,n1,length_m,leaf_area_m2,leaf_area_per_m,wood_area_m2\n";
  for (const Truth::Panel& p : truth.panels)
    out += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", p.row, p.panel, p.from.x(),
                       p.from.y(), p.to.x(), p.to.y(), p.length_m, p.leaf_area_m2, p.leaf_area_m2 / p.length_m,
                       p.wood_area_m2);
  return out;
}

Text metres_text(const Truth& truth) {
  Text out = "row,along_m,e,n,leaf_area_per_m,wood_area_per_m\n";
  for (const Truth::Metre& m : truth.metres)
    out += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", m.row, m.along_m, m.position.x(), m.position.y(),
                       m.leaf_area_per_m, m.wood_area_per_m);
  return out;
}

// NaN is an empty field.
Text field(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : Text(); }

constexpr const char* kCanopyColumns =
    "base_m,height_m,width_m,row_gap_share,porosity,leaf_layer_number,canopy_layer_number,exposed_leaf_share";

Text canopy_fields(const CanopyTruth& c) {
  Text out;
  for (const double value : {c.base_m, c.height_m, c.width_m, c.row_gap_share, c.porosity, c.leaf_layer_number,
                             c.canopy_layer_number, c.exposed_leaf_share})
    out += "," + field(value);
  return out + "\n";
}

Text canopy_text(const Truth& truth) {
  Text out = fmt::format("row,panel,{}\n", kCanopyColumns);
  for (const Truth::Panel& p : truth.panels) out += fmt::format("{},{}{}", p.row, p.panel, canopy_fields(p.canopy));
  return out;
}

Text canopy_metres_text(const Truth& truth) {
  Text out = fmt::format("row,along_m,{}\n", kCanopyColumns);
  for (const Truth::Metre& m : truth.metres)
    out += fmt::format("{},{:.9g}{}", m.row, m.along_m, canopy_fields(m.canopy));
  return out;
}

Text canopy_profile_text(const Truth& truth) {
  Text out = "row,panel,height_low_m,height_high_m,leaf_area_m2,wood_area_m2\n";
  for (const Truth::Panel& p : truth.panels)
    for (const CanopyBand& band : p.profile)
      out += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g}\n", p.row, p.panel, band.low_m, band.high_m, band.leaf_m2,
                         band.wood_m2);
  return out;
}

Text posts_text(const Truth& truth) {
  Text out = "row,post,along_m,e,n,z,height_m,diameter_m,kind\n";
  for (const Post& p : truth.posts)
    out += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", p.row, p.post, p.chainage_m,
                       p.position.x(), p.position.y(), p.ground_m, p.height_m, p.diameter_m,
                       p.kind == PostKind::strainer ? "strainer" : "line");
  return out;
}

Text ground_text(const Truth& truth) {
  Text out = "e,n,z\n";
  for (const Eigen::Vector3d& p : truth.ground) out += fmt::format("{:.9g},{:.9g},{:.9g}\n", p.x(), p.y(), p.z());
  return out;
}

Text json_string(const std::string& text) {
  Text out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

Text site_text(const Truth& truth) {
  const Site& site = truth.site;
  const SiteDate& date = site.dates[truth.date_index];
  const std::string code = site.crs_code();
  const std::string epsg = code.rfind("EPSG:", 0) == 0 ? code.substr(5) : "null";
  const std::size_t panels = truth.panels.size() / truth.rows.size();
  return fmt::format(
      "{{\"name\":{},\"lat\":{:.12g},\"lon\":{:.12g},\"alt\":{:.12g},\"epsg\":{},\"crs\":{},\"rows\":{},\"row_len\":{:."
      "12g},"
      "\"spacing\":{:.12g},\"azimuth\":{:.12g},\"curve_radius\":{:.12g},\"panels_per_row\":{},\"date\":{},"
      "\"leaf_fraction\":{:.12g},\"leaf_area_m2\":{:.12g},\"wood_area_m2\":{:.12g},\"leaves\":{},\"speed\":{:.12g},"
      "\"site_seed\":{},\"drive_seed\":{},\"duration_s\":{:.12g},\"path_m\":{:.12g},\"t0\":{:.12g}}}\n",
      json_string(site.name), site.latitude_deg, site.longitude_deg, site.height_m, epsg, json_string(code),
      site.rows.count, site.rows.length_m, site.rows.spacing_m, site.rows.azimuth_deg, site.rows.curve_radius_m, panels,
      json_string(date.date), date.leaf_fraction, truth.leaf_area_m2, truth.wood_area_m2, truth.leaf_count,
      date.speed_m_s, site.seed, date.seed, truth.duration_s, truth.path_m, truth.start_time_s);
}

Result<void> write_text(const std::filesystem::path& path, const Text& text) {
  return write_whole_file(path.string(), std::as_bytes(std::span(text)), "cannot write truth",
                          "check the folder and the space on the disk");
}

}  // namespace

Result<void> write_truth(const Truth& truth, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail_errno(error.value(), "cannot make folder", folder.string());
  RAYFIELD_CHECK(write_text(folder / "trajectory.tum", trajectory_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "trajectory_map.tum", map_trajectory_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "rows.csv", rows_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "panels.csv", panels_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "metres.csv", metres_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "canopy.csv", canopy_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "canopy_metres.csv", canopy_metres_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "canopy_profile.csv", canopy_profile_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "posts.csv", posts_text(truth)));
  RAYFIELD_CHECK(write_text(folder / "ground.csv", ground_text(truth)));
  return write_text(folder / "site.json", site_text(truth));
}

}  // namespace rayfield::sim
