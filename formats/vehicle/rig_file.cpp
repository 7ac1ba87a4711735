#include "rayfield/formats/rig_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "formats/io/file_io.h"
#include "formats/io/toml_text.h"
#include "formats/vehicle/lidar_models.h"
#include "formats/vehicle/rig_section.h"
#include "rayfield/core/text_file.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = kRigWhat;

/// The beam from the data sheet of `model`, or as the file states it; what is stated rules.
void take_beam(RigSection& lidar, std::optional<LidarBeam>& out) {
  std::string model;
  lidar.text("model", model);
  if (!model.empty()) {
    if (const LidarBeam* known = beam_of_model(model)) {
      out = *known;
    } else if (!lidar.has("beam_diameter_m")) {
      lidar.refuse_key("model", "not a lidar whose beam is known (" + known_lidar_models() +
                                    "): give beam_diameter_m and beam_divergence_rad as well");
    }
  }
  LidarBeam beam = out.value_or(LidarBeam());
  lidar.number("beam_diameter_m", 0, kWidestBeam_m, beam.diameter_m);
  lidar.divergence("beam_divergence_rad", kWidestDivergence_rad, beam.divergence_rad);
  const bool is_line = lidar.has("beam_divergence_rad") && beam.divergence_rad == 0;
  if (lidar.has("beam_diameter_m") != lidar.has("beam_divergence_rad") && !out && !is_line)
    lidar.missing(lidar.has("beam_diameter_m") ? "beam_divergence_rad" : "beam_diameter_m",
                  "give both, or the lidar's model; see docs/rig.md");
  if (lidar.has("beam_diameter_m") || lidar.has("beam_divergence_rad")) out = beam;
  for (const char* key : {"detection_share", "range_resolution_m", "returns"})
    if (lidar.has(key) && !out)
      return lidar.refuse_key(key, "it needs beam_diameter_m and beam_divergence_rad beside it");
  if (lidar.has("detection_share")) lidar.number("detection_share", 0.001, 1, out->detection_share.emplace());
  if (lidar.has("range_resolution_m"))
    lidar.number("range_resolution_m", kFinestRange_m, kCoarsestRange_m, out->range_resolution_m.emplace());
  if (lidar.has("returns")) lidar.return_mode("returns", out->returns);
}

void take_lidar(RigSection& section, Rig::Lidar& lidar) {
  section.text("topic", lidar.topic);
  section.number("min_range_m", 0, 1000, lidar.min_range_m);
  section.number("max_range_m", 0.1, 1000, lidar.max_range_m);
  section.no_return("no_return", lidar.no_return);
  take_beam(section, lidar.beam);
}

void take_spinner(RigSection& spinner, Rig& rig) {
  if (!spinner.present()) return;
  rig.spinner = Rig::Spinner();
  spinner.text("topic", rig.spinner->topic);
  spinner.text("joint", rig.spinner->joint);
  spinner.direction("axis", rig.spinner->axis);
}

void take_time(RigSection& time, Rig& rig) {
  time.number("lidar_offset_s", -10, 10, rig.lidar_offset_s);
  time.number("gps_offset_s", -10, 10, rig.gps_offset_s);
  time.flag("estimate_lidar_offset", rig.estimate_lidar_offset);
  time.flag("estimate_spinner_offset", rig.estimate_spinner_offset);
  time.flag("estimate_gps_offset", rig.estimate_gps_offset);
}

void take_sensors(RigSection& lidar, RigSection& spinner, RigSection& imu, RigSection& gps, Rig& rig) {
  take_lidar(lidar, rig.lidar);
  take_spinner(spinner, rig);
  imu.text("topic", rig.imu.topic);
  imu.number("gyro_noise_rad_s_sqrt_hz", 1e-9, 10, rig.imu.gyro_noise_rad_s_sqrt_hz);
  imu.number("accel_noise_m_s2_sqrt_hz", 1e-9, 10, rig.imu.accel_noise_m_s2_sqrt_hz);
  imu.number("gyro_bias_rad_s2_sqrt_hz", 1e-12, 10, rig.imu.gyro_bias_rad_s2_sqrt_hz);
  imu.number("accel_bias_m_s3_sqrt_hz", 1e-12, 10, rig.imu.accel_bias_m_s3_sqrt_hz);
  if (gps.present()) {
    rig.gps = Rig::Gps();
    gps.text("topic", rig.gps->topic);
  }
}

/// Identity is a rare rig, so nothing is assumed: every sensor's place must be given.
void take_extrinsics(RigSection& extrinsics, Rig& rig) {
  constexpr std::string_view kMeasure = "measure how the sensors are mounted; see docs/rig.md";
  Rigid3 antenna;
  const bool has_antenna = extrinsics.pose("imu_from_gps", false, antenna);
  rig.imu_from_gps_m = antenna.translation;
  if (rig.gps && !has_antenna) extrinsics.missing("imu_from_gps", kMeasure);
  if (rig.spinner) {
    extrinsics.refuse_key("imu_from_lidar", "the rig has a spinner: give imu_from_spinner and spinner_from_lidar");
    if (!extrinsics.pose("imu_from_spinner", true, rig.imu_from_spinner)) {
      extrinsics.missing("imu_from_spinner", kMeasure);
    }
    if (!extrinsics.pose("spinner_from_lidar", true, rig.spinner_from_lidar)) {
      extrinsics.missing("spinner_from_lidar", kMeasure);
    }
    return;
  }
  // A spinner that does not turn: both parts together are the mounting of a fixed lidar.
  Rigid3 imu_from_base, base_from_lidar, imu_from_lidar;
  const bool direct = extrinsics.pose("imu_from_lidar", true, imu_from_lidar);
  if (direct) {
    extrinsics.refuse_key("imu_from_spinner", "imu_from_lidar says it already");
    extrinsics.refuse_key("spinner_from_lidar", "imu_from_lidar says it already");
    rig.spinner_from_lidar = imu_from_lidar;
    return;
  }
  extrinsics.pose("imu_from_spinner", true, imu_from_base);
  if (!extrinsics.pose("spinner_from_lidar", true, base_from_lidar)) extrinsics.missing("imu_from_lidar", kMeasure);
  rig.spinner_from_lidar = imu_from_base * base_from_lidar;
}

std::string vector_text(const Eigen::Vector3d& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string pose_text(const Rigid3& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  return fmt::format("{{ xyz = {}, q = [{}, {}, {}, {}] }}", vector_text(pose.translation), q.x(), q.y(), q.z(), q.w());
}

std::string beam_text(const std::optional<LidarBeam>& beam) {
  if (!beam) return "";
  std::string text =
      fmt::format("beam_diameter_m = {}\nbeam_divergence_rad = {}\n", beam->diameter_m, beam->divergence_rad);
  if (beam->detection_share) text += fmt::format("detection_share = {}\n", *beam->detection_share);
  if (beam->range_resolution_m) text += fmt::format("range_resolution_m = {}\n", *beam->range_resolution_m);
  if (beam->returns) text += fmt::format("returns = \"{}\"\n", name_of(*beam->returns));
  return text;
}

std::string_view no_return_text(NoReturn no_return) {
  return no_return == NoReturn::zero ? "zero" : no_return == NoReturn::max_range ? "max" : "inf";
}

Result<toml::table> parse_tables(std::string_view text, const std::string& name) {
  RAYFIELD_CHECK(check_toml_text(text, kWhat, name, "see docs/rig.md"));
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::usage, kWhat, fmt::format("{}, line {}", name, e.source().begin.line), e.description(),
                "see docs/rig.md");
  }
}

}  // namespace

Result<void> validate_rig(const Rig& rig) {
  const auto bad = [](const char* where, const char* why) { return fail(ErrorCode::usage, kWhat, where, why); };
  if (!(rig.lidar.min_range_m >= 0 && rig.lidar.min_range_m < rig.lidar.max_range_m)) {
    return bad("lidar", "min_range_m must be at least 0 and below max_range_m");
  }
  if (const auto& beam = rig.lidar.beam) {
    if (!(beam->diameter_m >= 0 && beam->diameter_m <= kWidestBeam_m))
      return bad("lidar.beam_diameter_m", "must be 0 to 0.2");
    if (!(beam->divergence_rad >= 0 && beam->divergence_rad <= kWidestDivergence_rad))
      return bad("lidar.beam_divergence_rad", "must be 0 to 0.1");
    if (beam->detection_share && !(*beam->detection_share > 0 && *beam->detection_share <= 1))
      return bad("lidar.detection_share", "must be above 0 and at most 1");
    if (beam->range_resolution_m &&
        !(*beam->range_resolution_m >= kFinestRange_m && *beam->range_resolution_m <= kCoarsestRange_m))
      return bad("lidar.range_resolution_m", "must be 0.005 to 2");
  }
  const auto is_unit = [](double norm) { return std::abs(norm - 1.0) <= kRigUnitTolerance; };
  if (rig.spinner && !is_unit(rig.spinner->axis.norm())) return bad("spinner.axis", "must be a unit vector");
  if (!is_unit(rig.imu_from_spinner.rotation.norm())) return bad("imu_from_spinner", "its quaternion is not unit");
  if (!is_unit(rig.spinner_from_lidar.rotation.norm())) return bad("spinner_from_lidar", "its quaternion is not unit");
  std::vector<std::string> topics = {rig.lidar.topic, rig.imu.topic};
  if (rig.spinner) topics.push_back(rig.spinner->topic);
  if (rig.gps) topics.push_back(rig.gps->topic);
  for (std::size_t i = 0; i < topics.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (topics[i] == topics[j]) return bad(topics[i].c_str(), "two sensors have the same topic");
    }
  }
  return {};
}

Result<Rig> parse_rig(std::string_view text, const std::string& name) {
  RAYFIELD_ASSIGN(const toml::table parsed, parse_tables(text, name));
  RigSection file(&parsed, "", name);
  RigSection lidar = file.section("lidar"), spinner = file.section("spinner"), imu = file.section("imu");
  RigSection gps = file.section("gps"), extrinsics = file.section("extrinsics"), time = file.section("time");
  RAYFIELD_CHECK(file.finish());
  Rig rig;
  take_sensors(lidar, spinner, imu, gps, rig);
  take_extrinsics(extrinsics, rig);
  take_time(time, rig);
  for (RigSection* each : {&lidar, &spinner, &imu, &gps, &extrinsics, &time}) RAYFIELD_CHECK(each->finish());
  if (const Result<void> valid = validate_rig(rig); !valid) {
    return fail(ErrorCode::usage, kWhat, name + ", " + valid.error().where, valid.error().why, "see docs/rig.md");
  }
  return rig;
}

Result<Rig> read_rig(const std::string& path) {
  RAYFIELD_ASSIGN(const std::string text, read_text_file(path, kWhat));
  return parse_rig(text, path);
}

Result<std::optional<LidarBeam>> read_rig_beam(const std::string& path) {
  RAYFIELD_ASSIGN(const std::string text, read_text_file(path, kWhat));
  RAYFIELD_ASSIGN(const toml::table parsed, parse_tables(text, path));
  RigSection file(&parsed, "", path);
  RigSection lidar = file.section("lidar");
  Rig rig;
  take_lidar(lidar, rig.lidar);
  RAYFIELD_CHECK(lidar.finish());
  return rig.lidar.beam;
}

/// A spinner carries the lidar round a circle about its axis: what stays is the circle's centre.
Eigen::Vector3d mean_lidar_in_imu_m(const Rig& rig) {
  if (!rig.spinner) return (rig.imu_from_spinner * rig.spinner_from_lidar).translation;
  const Eigen::Vector3d& axis = rig.spinner->axis;
  return rig.imu_from_spinner * Eigen::Vector3d(axis * axis.dot(rig.spinner_from_lidar.translation));
}

Result<RigMounting> read_rig_mounting(const std::string& path) {
  RAYFIELD_ASSIGN(const std::string text, read_text_file(path, kWhat));
  RAYFIELD_ASSIGN(const toml::table parsed, parse_tables(text, path));
  RigSection file(&parsed, "", path);
  RigSection spinner = file.section("spinner"), extrinsics = file.section("extrinsics"), time = file.section("time");
  Rig rig;
  take_spinner(spinner, rig);
  if (extrinsics.present()) take_extrinsics(extrinsics, rig);
  take_time(time, rig);
  for (RigSection* each : {&spinner, &extrinsics, &time}) RAYFIELD_CHECK(each->finish());
  RigMounting mounting;
  if (extrinsics.present()) mounting.lidar_in_imu_m = mean_lidar_in_imu_m(rig);
  mounting.lidar_offset_s = rig.lidar_offset_s;
  return mounting;
}

/// Numbers are written with as many digits as bring the same double back.
std::string rig_text(const Rig& rig) {
  std::string out = fmt::format("[lidar]\ntopic = {}\nmin_range_m = {}\nmax_range_m = {}\nno_return = \"{}\"\n{}\n",
                                toml_quoted(rig.lidar.topic), rig.lidar.min_range_m, rig.lidar.max_range_m,
                                no_return_text(rig.lidar.no_return), beam_text(rig.lidar.beam));
  if (rig.spinner) {
    out += fmt::format("[spinner]\ntopic = {}\njoint = {}\naxis = {}\n\n", toml_quoted(rig.spinner->topic),
                       toml_quoted(rig.spinner->joint), vector_text(rig.spinner->axis));
  }
  out += fmt::format(
      "[imu]\ntopic = {}\ngyro_noise_rad_s_sqrt_hz = {}\naccel_noise_m_s2_sqrt_hz = {}\n"
      "gyro_bias_rad_s2_sqrt_hz = {}\naccel_bias_m_s3_sqrt_hz = {}\n\n",
      toml_quoted(rig.imu.topic), rig.imu.gyro_noise_rad_s_sqrt_hz, rig.imu.accel_noise_m_s2_sqrt_hz,
      rig.imu.gyro_bias_rad_s2_sqrt_hz, rig.imu.accel_bias_m_s3_sqrt_hz);
  if (rig.gps) out += fmt::format("[gps]\ntopic = {}\n\n", toml_quoted(rig.gps->topic));
  out += "[extrinsics]  # target_from_source; metres, quaternions x y z w\n";
  if (rig.spinner) {
    out += "imu_from_spinner = " + pose_text(rig.imu_from_spinner) + "\n";
    out += "spinner_from_lidar = " + pose_text(rig.spinner_from_lidar) + "\n";
  } else {
    out += "imu_from_lidar = " + pose_text(rig.imu_from_spinner * rig.spinner_from_lidar) + "\n";
  }
  if (rig.gps) out += fmt::format("imu_from_gps = {{ xyz = {} }}\n", vector_text(rig.imu_from_gps_m));
  out += fmt::format(
      "\n[time]\nlidar_offset_s = {}\ngps_offset_s = {}\nestimate_lidar_offset = {}\nestimate_spinner_offset = {}\n"
      "estimate_gps_offset = {}\n",
      rig.lidar_offset_s, rig.gps_offset_s, rig.estimate_lidar_offset, rig.estimate_spinner_offset,
      rig.estimate_gps_offset);
  return out;
}

Result<void> write_rig(const std::string& path, const Rig& rig) {
  RAYFIELD_CHECK(validate_rig(rig));
  RAYFIELD_ASSIGN(OutputFile file, OutputFile::create(path, "cannot write rig file"));
  RAYFIELD_CHECK(file.write(rig_text(rig)));
  return file.commit();
}

}  // namespace rayfield::formats
