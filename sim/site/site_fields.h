#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "rayfield/sim/site.h"

/// The keys of SITE.toml with their ranges, written once for reading (site_toml.cpp) and checking (site.cpp). A visitor
/// offers enter/leave, number, integer, flag, text, choice, numbers, integers, vector3, rigid and tables.
namespace rayfield::sim {

template <class E, std::size_t N>
using Choices = std::array<std::pair<std::string_view, E>, N>;

inline constexpr Choices<CanopyKind, 3> kCanopyKinds{
    {{"vsp", CanopyKind::vsp}, {"sprawl", CanopyKind::sprawl}, {"crown", CanopyKind::crown}}};
inline constexpr Choices<LeafShape, 3> kLeafShapes{
    {{"rhombus", LeafShape::rhombus}, {"triangle", LeafShape::triangle}, {"lobed", LeafShape::lobed}}};
inline constexpr Choices<LeafAngles, 7> kLeafAngles{{{"spherical", LeafAngles::spherical},
                                                     {"planophile", LeafAngles::planophile},
                                                     {"erectophile", LeafAngles::erectophile},
                                                     {"plagiophile", LeafAngles::plagiophile},
                                                     {"extremophile", LeafAngles::extremophile},
                                                     {"uniform", LeafAngles::uniform},
                                                     {"ellipsoidal", LeafAngles::ellipsoidal}}};
inline constexpr Choices<LidarKind, 2> kLidarKinds{
    {{"spinning", LidarKind::spinning}, {"multi_beam", LidarKind::multi_beam}}};
inline constexpr Choices<EnergyProfile, 2> kEnergyProfiles{
    {{"uniform", EnergyProfile::uniform}, {"gaussian", EnergyProfile::gaussian}}};
inline constexpr Choices<Detection, 2> kDetections{
    {{"covered_share", Detection::covered_share}, {"returned_energy", Detection::returned_energy}}};
inline constexpr Choices<LaneOrder, 3> kLaneOrders{
    {{"skip", LaneOrder::skip}, {"sequential", LaneOrder::sequential}, {"reverse", LaneOrder::reverse}}};

/// A bundle of this many rays fits on the stack of the ray caster.
inline constexpr int kMaxSubRays = 256, kMaxEchoes = 8;

/// What stands in the scene: terrain, rows, structure, canopy, surroundings.
template <class V>
void visit_scene(V& v, Site& s) {
  v.enter("terrain");
  v.number("slope_percent", s.terrain.slope_percent, 0, 40);
  v.number("slope_azimuth_deg", s.terrain.slope_azimuth_deg, -360, 360);
  v.number("relief_m", s.terrain.relief_m, 0, 10);
  v.number("relief_wavelength_m", s.terrain.relief_wavelength_m, 5, 1000);
  v.number("bank_height_m", s.terrain.bank_height_m, 0, 0.6);
  v.number("bank_width_m", s.terrain.bank_width_m, 0.2, 3);
  v.number("roughness_m", s.terrain.roughness_m, 0, 0.1);
  v.number("grass_per_m2", s.terrain.grass_per_m2, 0, 1000);
  v.number("grass_height_m", s.terrain.grass_height_m, 0.01, 1);
  v.leave();
  v.enter("rows");
  v.integer("count", s.rows.count, 1, 500);
  v.number("length_m", s.rows.length_m, 2, 2000);
  v.number("spacing_m", s.rows.spacing_m, 1, 20);
  v.number("azimuth_deg", s.rows.azimuth_deg, -360, 360);
  v.number("curve_radius_m", s.rows.curve_radius_m, -1e6, 1e6);
  v.number("panel_length_m", s.rows.panel_length_m, 1, 100);
  v.number("vine_spacing_m", s.rows.vine_spacing_m, 0.3, 20);
  v.number("missing_fraction", s.rows.missing_fraction, 0, 1);
  v.leave();
  v.enter("structure");
  v.number("post_height_m", s.structure.post_height_m, 0.3, 10);
  v.number("post_diameter_m", s.structure.post_diameter_m, 0.01, 1);
  v.number("strainer_height_m", s.structure.strainer_height_m, 0.3, 10);
  v.number("strainer_diameter_m", s.structure.strainer_diameter_m, 0.01, 1);
  v.numbers("wire_heights_m", s.structure.wire_heights_m, 0.05, 10, 20);
  v.number("wire_diameter_m", s.structure.wire_diameter_m, 0.0005, 0.05);
  v.number("trunk_diameter_m", s.structure.trunk_diameter_m, 0, 1);
  v.number("cordon_height_m", s.structure.cordon_height_m, 0.2, 5);
  v.number("cordon_diameter_m", s.structure.cordon_diameter_m, 0, 0.5);
  v.number("canes_per_m", s.structure.canes_per_m, 0, 100);
  v.number("cane_length_m", s.structure.cane_length_m, 0.05, 5);
  v.number("cane_diameter_m", s.structure.cane_diameter_m, 0.001, 0.1);
  v.leave();
  v.enter("canopy");
  v.choice("kind", s.canopy.kind, kCanopyKinds);
  v.number("bottom_m", s.canopy.bottom_m, 0.1, 10);
  v.number("top_m", s.canopy.top_m, 0.2, 15);
  v.number("width_m", s.canopy.width_m, 0.05, 15);
  v.number("leaf_area_m2_per_m", s.canopy.leaf_area_m2_per_m, 0, 100);
  v.number("leaf_size_min_cm2", s.canopy.leaf_size_min_cm2, 1, 2000);
  v.number("leaf_size_max_cm2", s.canopy.leaf_size_max_cm2, 1, 2000);
  v.choice("leaf_shape", s.canopy.leaf_shape, kLeafShapes);
  v.choice("leaf_angles", s.canopy.leaf_angles, kLeafAngles);
  v.number("ellipsoid_ratio", s.canopy.ellipsoid_ratio, 0.1, 10);
  v.number("vigour_variation", s.canopy.vigour_variation, 0, 1);
  v.number("vigour_wavelength_m", s.canopy.vigour_wavelength_m, 1, 1000);
  v.number("vine_variation", s.canopy.vine_variation, 0, 1);
  v.leave();
  v.enter("surroundings");
  v.integer("trees", s.surroundings.trees, 0, 200);
  v.integer("buildings", s.surroundings.buildings, 0, 20);
  v.flag("fence", s.surroundings.fence);
  v.leave();
}

/// What drives through it and measures: vehicle, lidar, IMU, GPS; what surfaces reflect, wind and disturbances.
template <class V>
void visit_sensors(V& v, Site& s) {
  v.enter("vehicle");
  v.number("wander_m", s.vehicle.wander_m, 0, 0.5);
  v.number("turn_speed_m_s", s.vehicle.turn_speed_m_s, 0.1, 5);
  v.number("acceleration_m_s2", s.vehicle.acceleration_m_s2, 0.05, 3);
  v.number("suspension_frequency_hz", s.vehicle.suspension_frequency_hz, 0.3, 3);
  v.number("suspension_damping", s.vehicle.suspension_damping, 0.05, 2);
  v.number("bump_m", s.vehicle.bump_m, 0, 0.1);
  v.number("vibration_m", s.vehicle.vibration_m, 0, 0.01);
  v.number("imu_height_m", s.vehicle.imu_height_m, 0.3, 5);
  v.leave();
  v.enter("lidar");
  v.choice("kind", s.lidar.kind, kLidarKinds);
  v.number("min_range_m", s.lidar.min_range_m, 0.01, 5);
  v.number("max_range_m", s.lidar.max_range_m, 1, 300);
  v.number("range_noise_m", s.lidar.range_noise_m, 0, 0.5);
  v.number("dropout_fraction", s.lidar.dropout_fraction, 0, 1);
  v.flag("keeps_downward_misses", s.lidar.keeps_downward_misses);
  v.number("beam_diameter_m", s.lidar.beam_diameter_m, 0, 0.2);
  v.number("divergence_mrad", s.lidar.divergence_mrad, 0, 50);
  v.number("divergence_z_mrad", s.lidar.divergence_z_mrad, 0, 50);
  v.choice("energy_profile", s.lidar.energy_profile, kEnergyProfiles);
  v.number("detection_share", s.lidar.detection_share, 0.001, 1);
  v.number("echo_scatter", s.lidar.echo_scatter, 0, 0.5);
  v.number("detection_range_exponent", s.lidar.detection_range_exponent, -4, 4);
  v.number("range_resolution_m", s.lidar.range_resolution_m, 0, 2);
  v.choice("detection", s.lidar.detection, kDetections);
  v.choice("returns", s.lidar.returns, kReturnModes);
  v.integer("echoes", s.lidar.echoes, 1, kMaxEchoes);
  v.integer("sub_rays", s.lidar.sub_rays, 1, kMaxSubRays);
  v.leave();
  v.enter("reflectance");
  v.number("ground", s.reflectance.ground, 0.01, 1);
  v.number("grass", s.reflectance.grass, 0.01, 1);
  v.number("leaf", s.reflectance.leaf, 0.01, 1);
  v.number("wood", s.reflectance.wood, 0.01, 1);
  v.number("post", s.reflectance.post, 0.01, 1);
  v.number("wire", s.reflectance.wire, 0.01, 1);
  v.number("building", s.reflectance.building, 0.01, 1);
  v.number("angle_dependence", s.reflectance.angle_dependence, 0, 1);
  v.leave();
  v.enter("wind");
  v.number("rms_m", s.wind.rms_m, 0, 0.3);
  v.number("coherence_m", s.wind.coherence_m, 0.01, 100);
  v.leave();
  v.enter("disturbance");
  v.number("dust_share", s.disturbance.dust_share, 0, 0.5);
  v.number("rain_per_m", s.disturbance.rain_per_m, 0, 0.1);
  v.number("spurious_share", s.disturbance.spurious_share, 0, 0.5);
  v.number("lost_echo_share", s.disturbance.lost_echo_share, 0, 1);
  v.leave();
  v.enter("spinning");
  v.integer("beams", s.spinning.beams, 2, 10000);
  v.number("field_of_view_deg", s.spinning.field_of_view_deg, 1, 360);
  v.number("rate_hz", s.spinning.rate_hz, 1, 1000);
  v.number("time_increment_s", s.spinning.time_increment_s, 0, 0.01);
  v.number("spin_rate_hz", s.spinning.spin_rate_hz, -20, 20);
  v.number("spin_wobble_rad", s.spinning.spin_wobble_rad, 0, 0.1);
  v.number("encoder_rate_hz", s.spinning.encoder_rate_hz, 1, 2000);
  v.number("encoder_noise_rad", s.spinning.encoder_noise_rad, 0, 0.1);
  v.leave();
  v.enter("multi_beam");
  v.integer("beams", s.multi_beam.beams, 1, 256);
  v.number("elevation_min_deg", s.multi_beam.elevation_min_deg, -90, 90);
  v.number("elevation_max_deg", s.multi_beam.elevation_max_deg, -90, 90);
  v.integer("azimuth_steps", s.multi_beam.azimuth_steps, 4, 10000);
  v.number("rate_hz", s.multi_beam.rate_hz, 0.5, 100);
  v.leave();
  v.enter("mount");
  v.rigid("imu_from_spinner", s.mount.imu_from_spinner);
  v.rigid("spinner_from_lidar", s.mount.spinner_from_lidar);
  v.rigid("imu_from_lidar", s.mount.imu_from_lidar);
  v.vector3("imu_from_gps_m", s.mount.imu_from_gps_m);
  v.leave();
  v.enter("imu");
  v.number("rate_hz", s.imu.rate_hz, 10, 2000);
  v.number("gyro_noise_rad_s_sqrt_hz", s.imu.gyro_noise_rad_s_sqrt_hz, 0, 1);
  v.number("accel_noise_m_s2_sqrt_hz", s.imu.accel_noise_m_s2_sqrt_hz, 0, 1);
  v.number("gyro_bias_rad_s", s.imu.gyro_bias_rad_s, 0, 1);
  v.number("accel_bias_m_s2", s.imu.accel_bias_m_s2, 0, 5);
  v.number("gyro_bias_walk_rad_s2_sqrt_hz", s.imu.gyro_bias_walk_rad_s2_sqrt_hz, 0, 1);
  v.number("accel_bias_walk_m_s3_sqrt_hz", s.imu.accel_bias_walk_m_s3_sqrt_hz, 0, 1);
  v.leave();
  v.enter("gps");
  v.flag("enabled", s.gps.enabled);
  v.number("rate_hz", s.gps.rate_hz, 0.1, 100);
  v.number("bias_horizontal_m", s.gps.bias_horizontal_m, 0, 50);
  v.number("bias_vertical_m", s.gps.bias_vertical_m, 0, 50);
  v.number("bias_time_constant_s", s.gps.bias_time_constant_s, 1, 1e6);
  v.number("noise_horizontal_m", s.gps.noise_horizontal_m, 0, 50);
  v.number("noise_vertical_m", s.gps.noise_vertical_m, 0, 50);
  v.number("reported_horizontal_m", s.gps.reported_horizontal_m, 0, 100);
  v.number("reported_vertical_m", s.gps.reported_vertical_m, 0, 100);
  v.leave();
}

template <class V>
void visit_date(V& v, SiteDate& d) {
  v.text("date", d.date);
  v.text("name", d.name);
  v.number("leaf_fraction", d.leaf_fraction, 0, 1);
  v.number("speed_m_s", d.speed_m_s, 0.1, 5);
  v.integer("seed", d.seed, 0, 9007199254740992.0);
  v.choice("order", d.order, kLaneOrders);
  v.integers("lanes", d.lanes, 0, 500, 5000);
  v.number("stationary_start_s", d.stationary_start_s, 0, 600);
  v.number("imu_noise_scale", d.imu_noise_scale, 0, 100);
  v.number("gps_bias_scale", d.gps_bias_scale, 0, 100);
  v.number("lidar_time_error_s", d.lidar_time_error_s, -1, 1);
  v.number("gps_time_error_s", d.gps_time_error_s, -1, 1);
  v.number("spinner_angle_error_rad", d.spinner_angle_error_rad, -1, 1);
  v.tables("gps_outages", d.gps_outages, [&](GpsOutage& outage) {
    v.number("start_s", outage.start_s, 0, 1e6);
    v.number("duration_s", outage.duration_s, 0, 1e6);
  });
  v.tables("gps_jumps", d.gps_jumps, [&](GpsJump& jump) {
    v.number("start_s", jump.start_s, 0, 1e6);
    v.number("duration_s", jump.duration_s, 0, 1e6);
    v.number("east_m", jump.east_m, -1000, 1000);
    v.number("north_m", jump.north_m, -1000, 1000);
    v.number("up_m", jump.up_m, -1000, 1000);
  });
}

template <class V>
void visit_site(V& v, Site& s) {
  v.enter("site");
  v.text("name", s.name);
  v.number("latitude_deg", s.latitude_deg, -80, 84);
  v.number("longitude_deg", s.longitude_deg, -180, 180);
  v.number("height_m", s.height_m, -500, 9000);
  v.text("crs", s.crs);
  v.integer("seed", s.seed, 0, 9007199254740992.0);
  v.leave();
  visit_scene(v, s);
  visit_sensors(v, s);
  v.tables("date", s.dates, [&](SiteDate& date) { visit_date(v, date); });
}

/// What is wrong with a site beyond single values: the key and the reason; an empty key means nothing is.
struct SiteFinding {
  std::string key, why;
};
SiteFinding check_consistency(const Site& site);

}  // namespace rayfield::sim
