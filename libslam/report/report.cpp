#include "rayfield/slam/report.h"

#include <fmt/format.h>

#include <cmath>

#include "rayfield/core/date.h"

namespace rayfield::slam {
namespace {

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += '\\', out += c;
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + '"';
}

std::string number(double v, int digits = 9) { return std::isfinite(v) ? fmt::format("{:.{}g}", v, digits) : "null"; }

std::string vector3(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", number(v.x(), 6), number(v.y(), 6), number(v.z(), 6));
}

// Writes one object: members in order, commas where they belong.
class Object {
 public:
  Object& raw(std::string_view key, const std::string& value) {
    text_ += fmt::format("{}{}: {}", text_.empty() ? "" : ", ", quoted(key), value);
    return *this;
  }
  Object& set(std::string_view key, double value) { return raw(key, number(value)); }
  Object& set(std::string_view key, std::uint64_t value) { return raw(key, fmt::format("{}", value)); }
  Object& set(std::string_view key, int value) { return raw(key, fmt::format("{}", value)); }
  Object& set(std::string_view key, bool value) { return raw(key, value ? "true" : "false"); }
  Object& set(std::string_view key, const std::string& value) { return raw(key, quoted(value)); }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

template <class Items, class Render>
std::string array(const Items& items, const Render& render) {
  std::string out = "[";
  for (std::size_t k = 0; k < items.size(); ++k) out += (k > 0 ? ", " : "") + render(items[k]);
  return out + "]";
}

std::string residual(const ResidualSummary& r) { return Object().set("count", r.count).set("rms", r.rms).text(); }

std::string gps_object(const GpsSummary& g) {
  return Object()
      .set("fixes", g.fixes)
      .set("used", g.used)
      .set("outliers", g.outliers)
      .set("longest_outage_s", g.longest_outage_s)
      .set("median_offset_m", g.median_offset_m)
      .set("p95_offset_m", g.p95_offset_m)
      .set("max_offset_m", g.max_offset_m)
      .raw("mean_offset_m", vector3(g.mean_offset_m))
      .set("yaw_sigma_rad", g.yaw_sigma_rad)
      .set("release_shift_mean_m", g.release_shift_mean_m)
      .set("release_shift_max_m", g.release_shift_max_m)
      .text();
}

}  // namespace

// Members in the order of docs/slam.md, "The report".
std::string report_json(const SlamReport& r) {
  Object residuals;
  residuals.raw("window_surfels_m", residual(r.window_surfels_m))
      .raw("near_surfels_m", residual(r.near_surfels_m))
      .raw("revisit_surfels_m", residual(r.revisit_surfels_m))
      .raw("poles_m", residual(r.poles_m))
      .raw("gps_m", residual(r.gps_m))
      .raw("gyro_rad_s", residual(r.gyro_rad_s))
      .raw("accel_m_s2", residual(r.accel_m_s2));
  Object o;
  o.raw("start_s", fmt::format("{:.6f}", r.start_s)).raw("end_s", fmt::format("{:.6f}", r.end_s));
  o.set("start_utc", utc_text(r.start_s)).set("duration_s", r.end_s - r.start_s).set("length_m", r.length_m);
  o.set("crs", r.crs).set("georeferenced", r.georeferenced).set("frame", r.frame_note);
  o.set("stationary_start_s", r.stationary_start_s).set("initial_speed_m_s", r.initial_speed_m_s);
  o.set("lidar_scans", r.lidar_scans).set("lidar_points", r.lidar_points).set("lidar_hits", r.lidar_hits);
  o.set("surfels", r.surfels).set("windows", r.windows);
  o.set("range_resolution_m", r.range_resolution_m).set("range_resolution_sigma_m", r.range_resolution_sigma_m);
  o.set("max_spot_depth_m", r.max_spot_depth_m);
  o.raw("residuals", residuals.text());
  o.set("loop_closures", r.loop_closures).set("linked_visits", r.linked_visits);
  o.set("pole_depth_m", r.pole_depth_m);
  o.set("surfel_thickness_m", r.surfel_thickness_m).set("imu_misfit", r.imu_misfit);
  o.set("window_inliers_least", r.window_inliers_least).set("window_inliers_typical", r.window_inliers_typical);
  o.set("visit_offset_worst_m", r.visit_offset_worst_m).set("visit_offset_typical_m", r.visit_offset_typical_m);
  o.raw("gps", gps_object(r.gps));
  o.raw("degenerate", array(r.degenerate, [](const DegenerateSpan& d) {
          return Object()
              .raw("start_s", fmt::format("{:.3f}", d.start_s))
              .raw("end_s", fmt::format("{:.3f}", d.end_s))
              .raw("direction", vector3(d.direction))
              .set("sigma_m", d.sigma_m)
              .text();
        }));
  o.raw("uncertainty", array(r.uncertainty, [](const PoseSigma& u) {
          return Object()
              .raw("time_s", fmt::format("{:.3f}", u.time_s))
              .raw("translation_m", vector3(u.translation_m))
              .raw("rotation_rad", vector3(u.rotation_rad))
              .text();
        }));
  o.raw("offsets", array(r.offsets, [](const OffsetEstimate& e) {
          return Object().set("name", e.name).set("value", e.value).set("sigma", e.sigma).text();
        }));
  o.raw("gyro_bias_rad_s", vector3(r.gyro_bias_rad_s)).raw("accel_bias_m_s2", vector3(r.accel_bias_m_s2));
  o.raw("stages", array(r.stages, [](const StageTime& s) {
          return Object()
              .set("name", s.name)
              .set("seconds", s.seconds)
              .set("real_time_factor", s.real_time_factor)
              .text();
        }));
  o.raw("warnings", array(r.warnings, [](const std::string& w) { return quoted(w); }));
  return o.text() + "\n";
}

// One line per subject, each with a caption of eleven characters.
std::string report_summary(const SlamReport& r) {
  std::string out = fmt::format("drive      {}, {:.1f} s, {:.1f} m, {} lidar hits\n", utc_text(r.start_s),
                                r.end_s - r.start_s, r.length_m, r.lidar_hits);
  out += fmt::format("frame      {}{}{}\n", r.crs, r.crs.empty() ? "" : ": ", r.frame_note);
  out += r.stationary_start_s > 0 ? fmt::format("start      at rest for {:.1f} s\n", r.stationary_start_s)
                                  : fmt::format("start      in motion, {:.2f} m/s\n", r.initial_speed_m_s);
  out += fmt::format("surfaces   {} surfels, {} loop closures between {} pairs of 5 s sections, ", r.surfels,
                     r.loop_closures, r.linked_visits);
  out += std::isfinite(r.surfel_thickness_m) ? fmt::format("{:.1f} mm thick\n", 1000 * r.surfel_thickness_m)
                                             : std::string("none seen twice\n");
  if (std::isfinite(r.range_resolution_m))
    out += fmt::format(
        "beam       resolves {:.2f} ± {:.2f} m in range; planes are used where its spot is up to {:.2f} m deep\n",
        r.range_resolution_m, r.range_resolution_sigma_m, r.max_spot_depth_m);
  if (r.poles_m.count > 0)
    out += fmt::format("poles      {} pairs of observations of posts and trunks, axes within {:.0f} mm\n",
                       r.poles_m.count, 1000 * r.poles_m.rms);
  if (r.gps.used > 0)
    out += fmt::format(
        "GPS        {} fixes, offset {:.2f} m (median), {:.2f} m (95 %), {} outliers, longest outage {:.1f} s\n",
        r.gps.used, r.gps.median_offset_m, r.gps.p95_offset_m, r.gps.outliers, r.gps.longest_outage_s);
  double worst = 0;
  for (const PoseSigma& u : r.uncertainty) worst = std::max(worst, u.translation_m.norm());
  out += fmt::format("shape      within {:.0f} mm (largest standard deviation against the middle of the drive)\n",
                     1000 * worst);
  for (const OffsetEstimate& e : r.offsets)
    out += fmt::format("estimated  {} = {:.6f} ± {:.6f}\n", e.name, e.value, e.sigma);
  for (const StageTime& s : r.stages)
    out += fmt::format("time       {}: {:.1f} s ({:.0f} × real time)\n", s.name, s.seconds, s.real_time_factor);
  for (const std::string& w : r.warnings) out += "warning    " + w + "\n";
  return out;
}

}  // namespace rayfield::slam
