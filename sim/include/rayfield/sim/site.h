#pragma once

/// site: a synthetic vineyard as numbers, how they are read and checked, and the random numbers that follow from it.

#include <cstdint>
#include <string>
#include <vector>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/result.h"
#include "rayfield/core/rigid3.h"

/// A synthetic vineyard as numbers: what SITE.toml says. Ranges are checked by Site::validate(); keys, units, defaults
/// and ranges are listed in docs/simulation.md.
namespace rayfield::sim {

struct SiteTerrain {
  double slope_percent = 0;         ///< rise per 100 m, 0–40
  double slope_azimuth_deg = 0;     ///< direction in which the ground rises, clockwise from north
  double relief_m = 0;              ///< two standard deviations of a smooth undulation, 0–10
  double relief_wavelength_m = 30;  ///< 5–1000
  double bank_height_m = 0.10;      ///< crest of the bank under the vines, 0–0.6
  double bank_width_m = 0.7;        ///< its full width at half height, 0.2–3
  double roughness_m = 0.008;       ///< standard deviation of clods and tufts 0.25 m apart, 0–0.1
  double grass_per_m2 = 40;         ///< blades in the lanes, 0–1000
  double grass_height_m = 0.07;     ///< mean height of a blade, 0.01–1
};

struct SiteRows {
  int count = 3;                ///< 1–500
  double length_m = 26;         ///< along each row's own centreline, 2–2000
  double spacing_m = 2.75;      ///< 1–20
  double azimuth_deg = 0;       ///< of the rows at mid-length, clockwise from north
  double curve_radius_m = 0;    ///< 0: straight; > 0 the rows curve to the right, < 0 to the left
  double panel_length_m = 6.5;  ///< between posts; the last panel takes what is left
  double vine_spacing_m = 1.8;  ///< 0.3–20
  double missing_fraction = 0;  ///< share of vines that are missing, 0–1
};

struct SiteStructure {
  double post_height_m = 1.8;         ///< above ground
  double post_diameter_m = 0.07;      ///< posts between panels
  double strainer_height_m = 1.9;     ///< the two end posts of each row
  double strainer_diameter_m = 0.12;  ///< the two end posts of each row
  std::vector<double> wire_heights_m = {0.9, 1.2, 1.5, 1.75};
  double wire_diameter_m = 0.003;
  double trunk_diameter_m = 0.055;  ///< 0: no trunks
  double cordon_height_m = 0.9;
  double cordon_diameter_m = 0.03;  ///< 0: no cordons
  double canes_per_m = 9;
  double cane_length_m = 0.8;
  double cane_diameter_m = 0.007;
};

enum class CanopyKind {
  vsp,     ///< vertical shoot positioning: a narrow wall
  sprawl,  ///< wide, shoots hang over to both sides
  crown,   ///< one ellipsoid per plant, as in orchards
};

/// Distribution of the angle between leaf normal and vertical (de Wit 1965; `ellipsoidal` Campbell 1986).
enum class LeafAngles { spherical, planophile, erectophile, plagiophile, extremophile, uniform, ellipsoidal };

/// Outline of a leaf; leaves are flat.
enum class LeafShape {
  rhombus,   ///< nearly square
  triangle,  ///< equilateral
  lobed,     ///< a star of five lobes, as of vine leaves
};

struct SiteCanopy {
  CanopyKind kind = CanopyKind::vsp;
  double bottom_m = 0.9;            ///< above ground
  double top_m = 1.9;               ///< above ground
  double width_m = 0.5;             ///< across the row
  double leaf_area_m2_per_m = 2.5;  ///< one-sided, all leaves present, mean over the planted vines
  double leaf_size_min_cm2 = 35;    ///< one-sided area of the smallest leaf
  double leaf_size_max_cm2 = 100;   ///< and of the largest; sizes are uniform in between
  LeafShape leaf_shape = LeafShape::rhombus;
  LeafAngles leaf_angles = LeafAngles::spherical;
  double ellipsoid_ratio = 1;      ///< χ of `ellipsoidal`: horizontal over vertical semi-axis, 0.1–10
  double vigour_variation = 0.35;  ///< standard deviation of vigour along the row, relative
  double vigour_wavelength_m = 12;
  double vine_variation = 0.15;  ///< standard deviation from vine to vine, relative
};

struct SiteSurroundings {
  int trees = 4;      ///< 0–200
  int buildings = 1;  ///< 0–20
  bool fence = true;
};

struct SiteVehicle {
  double wander_m = 0.07;       ///< standard deviation of the lateral offset from the lane's centre
  double turn_speed_m_s = 1.0;  ///< upper bound in headland turns
  double acceleration_m_s2 = 0.4;
  double suspension_frequency_hz = 1.6;
  double suspension_damping = 0.35;  ///< ratio to critical damping
  double bump_m = 0.018;             ///< standard deviation of what each wheel runs over
  double vibration_m = 0.0002;       ///< standard deviation of the engine's shake
  double imu_height_m = 1.75;        ///< above the ground at rest
};

enum class LidarKind {
  spinning,    ///< a 2-D scanner spun about the vertical
  multi_beam,  ///< a fixed scanner with several beams over 360°
};

/// Energy over the beam's cross-section. The diameter of a Gaussian beam is where it falls to 1/e².
enum class EnergyProfile { uniform, gaussian };

/// What decides whether surfaces make an echo: the share of the beam that they take, or what they send back of it.
enum class Detection { covered_share, returned_energy };

struct SiteLidar {
  LidarKind kind = LidarKind::spinning;
  double min_range_m = 0.2;
  double max_range_m = 40;
  double range_noise_m = 0.012;     ///< standard deviation
  double dropout_fraction = 0.002;  ///< returns reported as NaN
  /// Whether the ray cloud of true poses holds downward shots without a return, as that of a registered log does. Most
  /// clouds of others do not.
  bool keeps_downward_misses = false;
  double beam_diameter_m = 0;    ///< of the beam where it leaves the lidar
  double divergence_mrad = 0;    ///< full angle of the beam, in the lidar's x–y plane
  double divergence_z_mrad = 0;  ///< full angle across that plane; 0: the beam is round
  EnergyProfile energy_profile = EnergyProfile::uniform;
  double detection_share = 0.25;  ///< of the beam's energy that has to fall on leaves to make an echo
  Detection detection = Detection::covered_share;
  double echo_scatter = 0;  ///< relative standard deviation of what a surface sends back to a beam (speckle)
  double detection_range_exponent = 0;  ///< that share grows with (range / 5 m) to this power
  double range_resolution_m = 0.15;     ///< surfaces closer behind each other make one echo
  ReturnMode returns = ReturnMode::first;
  int echoes = 1;     ///< of a beam that the log holds at most, from the first on; several only with `returns` first
  int sub_rays = 37;  ///< per beam that has a width; 1: the beam is a line

  /// Whether the beam has a width; else it is a line.
  bool wide() const { return sub_rays > 1 && (beam_diameter_m > 0 || divergence_mrad > 0 || divergence_z_mrad > 0); }
};

/// Share of light that a surface sends back at right angles.
struct SiteReflectance {
  double ground = 0.35, grass = 0.5, leaf = 0.55, wood = 0.35, post = 0.45, wire = 0.7, building = 0.65;
  double angle_dependence = 0.7;  ///< a surface met at the angle i sends back 1 − this·(1 − cos i) of it
};

/// Leaves move with the wind during a drive; their mean place is the one of the truth.
struct SiteWind {
  double rms_m = 0;          ///< of a leaf's displacement, along each horizontal axis; a third of it up and down
  double coherence_m = 0.3;  ///< along the row: leaves closer than this move together, as those of a shoot
};

/// Returns that the scene does not explain, and echoes that get lost.
struct SiteDisturbance {
  double dust_share = 0;       ///< of beams that end in dust close to the vehicle
  double rain_per_m = 0;       ///< chance per metre that a drop ends the beam
  double spurious_share = 0;   ///< of beams with a false return anywhere within range
  double lost_echo_share = 0;  ///< of the weakest echoes that get lost; none from twice the detectable energy up
};

/// The spun 2-D scanner (SICK LMS511-like).
struct SiteSpinning {
  int beams = 286;
  double field_of_view_deg = 190;
  double rate_hz = 100;                   ///< scans per second
  double time_increment_s = 1.0 / 54000;  ///< from beam to beam
  double spin_rate_hz = 0.5;
  double spin_wobble_rad = 0.002;  ///< amplitude of a slow irregularity of the motor
  double encoder_rate_hz = 100;
  double encoder_noise_rad = 0.0002;
};

struct SiteMultiBeam {
  int beams = 16;
  double elevation_min_deg = -15, elevation_max_deg = 15;
  int azimuth_steps = 720;
  double rate_hz = 10;  ///< revolutions per second, one message each
};

struct SiteMount {
  Rigid3 imu_from_spinner;    ///< of a spun scanner
  Rigid3 spinner_from_lidar;  ///< of a spun scanner
  Rigid3 imu_from_lidar;      ///< of a fixed scanner
  Eigen::Vector3d imu_from_gps_m = {-0.42, 0.11, 0.55};
  SiteMount();
};

struct SiteImu {
  double rate_hz = 100;
  double gyro_noise_rad_s_sqrt_hz = 3e-4;
  double accel_noise_m_s2_sqrt_hz = 3e-3;
  double gyro_bias_rad_s = 0.003;  ///< standard deviation of the bias at the start
  double accel_bias_m_s2 = 0.05;   ///< standard deviation of the bias at the start
  double gyro_bias_walk_rad_s2_sqrt_hz = 1e-5;
  double accel_bias_walk_m_s3_sqrt_hz = 1e-4;
};

struct SiteGps {
  bool enabled = true;
  double rate_hz = 10;
  double bias_horizontal_m = 0.5;  ///< standard deviation of a first-order Gauss–Markov bias per axis
  double bias_vertical_m = 0.8;
  double bias_time_constant_s = 120;
  double noise_horizontal_m = 0.03;  ///< white
  double noise_vertical_m = 0.06;
  double reported_horizontal_m = 0.7, reported_vertical_m = 1.05;  ///< standard deviations in the message
};

struct GpsOutage {
  double start_s = 0, duration_s = 0;  ///< from the start of the log; no message in between
};

struct GpsJump {
  double start_s = 0, duration_s = 0;
  double east_m = 0, north_m = 0, up_m = 0;
};

enum class LaneOrder {
  skip,        ///< every second lane, then the others on the way back
  sequential,  ///< neighbouring lanes one after the other
  reverse,     ///< `sequential` from the other side
};

/// One scan of the block. Leaf i is present when its fixed random number lies under leaf_fraction, so the leaves of an
/// earlier date are a subset of those of a fuller one.
struct SiteDate {
  std::string date;  ///< YYYY-MM-DD; the log starts at midnight UTC
  std::string name;  ///< unique label; empty: the date
  double leaf_fraction = 1;
  double speed_m_s = 1.5;  ///< in the lanes, 0.1–5
  std::uint64_t seed = 1;  ///< drive and sensor errors
  LaneOrder order = LaneOrder::skip;
  std::vector<int> lanes;          ///< explicit order of lanes 0…rows; empty: all, in `order`
  double stationary_start_s = 10;  ///< 0: the log starts at full speed
  double imu_noise_scale = 1;
  double gps_bias_scale = 1;
  double lidar_time_error_s = 0;       ///< true time minus stamp, not stated in the rig
  double gps_time_error_s = 0;         ///< true time minus stamp, not stated in the rig
  double spinner_angle_error_rad = 0;  ///< true angle minus encoder, not stated in the rig
  std::vector<GpsOutage> gps_outages;
  std::vector<GpsJump> gps_jumps;

  const std::string& label() const { return name.empty() ? date : name; }
};

struct Site {
  std::string name = "block";
  double latitude_deg = -35.2186, longitude_deg = 138.5411, height_m = 82;  ///< of the block's centre, the ENU origin
  std::string crs;  ///< "EPSG:…"; empty: default_crs() of the place
  std::uint64_t seed = 1;
  SiteTerrain terrain;
  SiteRows rows;
  SiteStructure structure;
  SiteCanopy canopy;
  SiteSurroundings surroundings;
  SiteVehicle vehicle;
  SiteLidar lidar;
  SiteReflectance reflectance;
  SiteWind wind;
  SiteDisturbance disturbance;
  SiteSpinning spinning;
  SiteMultiBeam multi_beam;
  SiteMount mount;
  SiteImu imu;
  SiteGps gps;
  std::vector<SiteDate> dates;

  /// Errors: usage; `where` names the key ("date[1].speed_m_s").
  Result<void> validate() const;
  /// `crs`, or the default of the place.
  std::string crs_code() const;
};

/// GDA2020 / MGA zone in Australia, else the WGS 84 / UTM zone (without the exceptions of Norway and Svalbard).
std::string default_crs(double latitude_deg, double longitude_deg);

}  // namespace rayfield::sim
