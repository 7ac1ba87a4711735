#include "rayfield/formats/rig_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "formats/io/file_io.h"
#include "formats/io/toml_text.h"
#include "formats/vehicle/lidar_models.h"
#include "rayfield/core/text_file.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot use rig file";
constexpr double kUnitTolerance = 1e-3;

/// One table of the file. Keys are taken by name; finish() refuses those that nobody took. The first error stays.
class Section {
 public:
  Section(const toml::table* table, std::string name, std::string file)
      : table_(table), name_(std::move(name)), file_(std::move(file)) {}

  bool present() const { return table_ != nullptr; }
  /// A table inside this one; not present() where the file does not have it.
  Section section(std::string_view key) {
    const toml::node* node = take(key);
    if (node != nullptr && !node->is_table()) refuse(*node, key, "must be a table");
    return Section(node == nullptr ? nullptr : node->as_table(), std::string(key), file_);
  }
  bool has(std::string_view key) const { return table_ != nullptr && table_->contains(key); }

  void text(std::string_view key, std::string& out) {
    if (const toml::node* node = take(key)) {
      const std::optional<std::string> value = node->value_exact<std::string>();
      if (!value) return refuse(*node, key, "must be a string");
      if (value->empty()) return refuse(*node, key, "must not be empty");
      out = *value;
    }
  }
  void number(std::string_view key, double low, double high, double& out) {
    if (const toml::node* node = take(key)) {
      const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
      if (!value) return refuse(*node, key, "must be a number");
      if (!(*value >= low && *value <= high)) return refuse(*node, key, fmt::format("must be {} to {}", low, high));
      out = *value;
    }
  }
  void flag(std::string_view key, bool& out) {
    if (const toml::node* node = take(key)) {
      const std::optional<bool> value = node->value_exact<bool>();
      if (!value) return refuse(*node, key, "must be true or false");
      out = *value;
    }
  }
  void no_return(std::string_view key, NoReturn& out) {
    if (const toml::node* node = take(key)) {
      const std::string value = node->value_exact<std::string>().value_or("");
      if (value == "inf")
        out = NoReturn::infinity;
      else if (value == "zero")
        out = NoReturn::zero;
      else if (value == "max")
        out = NoReturn::max_range;
      else
        refuse(*node, key, "must be \"inf\", \"zero\" or \"max\"");
    }
  }
  void direction(std::string_view key, Eigen::Vector3d& out) {
    const toml::node* node = take(key);
    std::array<double, 3> values{};
    if (node == nullptr || !numbers(*node, key, values)) return;
    const Eigen::Vector3d vector(values[0], values[1], values[2]);
    if (!(std::abs(vector.norm() - 1.0) <= kUnitTolerance)) return refuse(*node, key, "must be a unit vector");
    out = vector.normalized();
  }
  /// { xyz = [x, y, z], q = [x, y, z, w] }; without rotation where `q_allowed` is false.
  bool pose(std::string_view key, bool q_allowed, Rigid3& out) {
    const toml::node* node = take(key);
    if (node == nullptr) return false;
    Section inner(node->as_table(), name_ + "." + std::string(key), file_);
    if (!inner.present()) {
      refuse(*node, key, "must be a table { xyz = [x, y, z], q = [x, y, z, w] }");
      return true;
    }
    if (!inner.has("xyz")) refuse(*node, key, "has no xyz");
    inner.translation(out.translation);
    if (q_allowed) inner.rotation(out.rotation);
    inner.finish();
    if (!error_ && inner.error_) error_ = std::move(inner.error_);
    return true;
  }
  void missing(std::string_view key, std::string_view next) {
    if (error_) return;
    error_ = Error{ErrorCode::usage, kWhat, file_, fmt::format("{}.{} is missing", name_, key), std::string(next)};
  }
  void refuse_key(std::string_view key, std::string_view why) {
    if (const toml::node* node = take(key)) refuse(*node, key, why);
  }
  /// The first thing that is wrong with this table.
  Result<void> finish() {
    if (table_ != nullptr && !error_) {
      for (const auto& [key, node] : *table_) {
        if (taken_.end() == std::find(taken_.begin(), taken_.end(), key.str())) {
          refuse(node, key.str(), "unknown key");
          break;
        }
      }
    }
    if (error_) return tl::make_unexpected(*error_);
    return {};
  }

 private:
  const toml::node* take(std::string_view key) {
    taken_.emplace_back(key);
    return table_ == nullptr ? nullptr : table_->get(key);
  }
  void refuse(const toml::node& node, std::string_view key, std::string_view why) {
    if (error_) return;
    const std::string full = name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
    error_ = Error{ErrorCode::usage, kWhat, fmt::format("{}, line {}", file_, node.source().begin.line),
                   fmt::format("{}: {}", full, why), "see docs/rig.md"};
  }
  template <std::size_t N>
  bool numbers(const toml::node& node, std::string_view key, std::array<double, N>& out) {
    const toml::array* array = node.as_array();
    bool good = array != nullptr && array->size() == N;
    for (std::size_t i = 0; good && i < N; ++i) {
      const toml::node& element = *array->get(i);
      out[i] = element.is_number() ? element.value<double>().value_or(NAN) : static_cast<double>(NAN);
      good = std::isfinite(out[i]);
    }
    if (!good) refuse(node, key, fmt::format("must be an array of {} numbers", N));
    return good;
  }
  void translation(Eigen::Vector3d& out) {
    constexpr double kLongest_m = 100;
    const toml::node* node = take("xyz");
    std::array<double, 3> values{};
    if (node == nullptr || !numbers(*node, "xyz", values)) return;
    out = {values[0], values[1], values[2]};
    if (out.cwiseAbs().maxCoeff() > kLongest_m) refuse(*node, "xyz", "must be within 100 m");
  }
  void rotation(Eigen::Quaterniond& out) {
    const toml::node* node = take("q");
    std::array<double, 4> values{};
    if (node == nullptr || !numbers(*node, "q", values)) return;
    const Eigen::Quaterniond rotation(values[3], values[0], values[1], values[2]);
    if (!(std::abs(rotation.norm() - 1.0) <= kUnitTolerance)) {
      return refuse(*node, "q", fmt::format("must be a unit quaternion x y z w; its norm is {:.6g}", rotation.norm()));
    }
    out = rotation.normalized();
  }

  const toml::table* table_;
  std::string name_, file_;
  std::vector<std::string> taken_;
  std::optional<Error> error_;
};

/// The beam from the data sheet of `model`, or as the file states it; what is stated rules.
void take_beam(Section& lidar, std::optional<LidarBeam>& out) {
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
  lidar.number("beam_divergence_rad", 0, kWidestDivergence_rad, beam.divergence_rad);
  if (lidar.has("beam_diameter_m") != lidar.has("beam_divergence_rad") && !out)
    lidar.missing(lidar.has("beam_diameter_m") ? "beam_divergence_rad" : "beam_diameter_m",
                  "give both, or the lidar's model; see docs/rig.md");
  if (lidar.has("beam_diameter_m") || lidar.has("beam_divergence_rad")) out = beam;
  for (const char* key : {"detection_share", "range_resolution_m"})
    if (lidar.has(key) && !out)
      return lidar.refuse_key(key, "it needs beam_diameter_m and beam_divergence_rad beside it");
  if (lidar.has("detection_share")) lidar.number("detection_share", 0.001, 1, out->detection_share.emplace());
  if (lidar.has("range_resolution_m"))
    lidar.number("range_resolution_m", kFinestRange_m, kCoarsestRange_m, out->range_resolution_m.emplace());
}

void take_lidar(Section& section, Rig::Lidar& lidar) {
  section.text("topic", lidar.topic);
  section.number("min_range_m", 0, 1000, lidar.min_range_m);
  section.number("max_range_m", 0.1, 1000, lidar.max_range_m);
  section.no_return("no_return", lidar.no_return);
  take_beam(section, lidar.beam);
}

void take_sensors(Section& lidar, Section& spinner, Section& imu, Section& gps, Rig& rig) {
  take_lidar(lidar, rig.lidar);
  if (spinner.present()) {
    rig.spinner = Rig::Spinner();
    spinner.text("topic", rig.spinner->topic);
    spinner.text("joint", rig.spinner->joint);
    spinner.direction("axis", rig.spinner->axis);
  }
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
void take_extrinsics(Section& extrinsics, Rig& rig) {
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
  const auto is_unit = [](double norm) { return std::abs(norm - 1.0) <= kUnitTolerance; };
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
  Section file(&parsed, "", name);
  Section lidar = file.section("lidar"), spinner = file.section("spinner"), imu = file.section("imu");
  Section gps = file.section("gps"), extrinsics = file.section("extrinsics"), time = file.section("time");
  RAYFIELD_CHECK(file.finish());
  Rig rig;
  take_sensors(lidar, spinner, imu, gps, rig);
  take_extrinsics(extrinsics, rig);
  time.number("lidar_offset_s", -10, 10, rig.lidar_offset_s);
  time.number("gps_offset_s", -10, 10, rig.gps_offset_s);
  time.flag("estimate_lidar_offset", rig.estimate_lidar_offset);
  time.flag("estimate_spinner_offset", rig.estimate_spinner_offset);
  time.flag("estimate_gps_offset", rig.estimate_gps_offset);
  for (Section* each : {&lidar, &spinner, &imu, &gps, &extrinsics, &time}) RAYFIELD_CHECK(each->finish());
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
  Section file(&parsed, "", path);
  Section lidar = file.section("lidar");
  Rig rig;
  take_lidar(lidar, rig.lidar);
  RAYFIELD_CHECK(lidar.finish());
  return rig.lidar.beam;
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
