#include "rayfield/formats/rig_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/io/toml_text.h"
#include "formats/vehicle/lidar_models.h"

namespace rayfield::formats {
namespace {

/// Shares above these make a convention: sensors hardly ever measure exactly 0, or exactly their largest range.
constexpr double kManyZeros = 0.01;
constexpr double kManyAtLargest = 0.01;

std::uint64_t messages_of(const LogInfo& info, const std::string& topic) {
  for (const TopicInfo& each : info.topics) {
    if (each.topic == topic) return each.messages;
  }
  return 0;
}

std::string frame_of(const LogInfo& info, const std::string& topic) {
  for (const TopicInfo& each : info.topics) {
    if (each.topic == topic) return each.frame_id;
  }
  return "";
}

/// The sensor whose topic has the most messages; null where there is none.
template <class Sensor>
const Sensor* busiest(const LogInfo& info, const std::vector<Sensor>& sensors) {
  const auto best = std::max_element(sensors.begin(), sensors.end(), [&](const Sensor& a, const Sensor& b) {
    return messages_of(info, a.topic) < messages_of(info, b.topic);
  });
  return best == sensors.end() ? nullptr : &*best;
}

const char* no_return_of(const LidarInfo& lidar) {
  const double points = static_cast<double>(std::max<std::uint64_t>(lidar.points, 1));
  if (lidar.infinite > 0) return "inf";
  if (static_cast<double>(lidar.zero) > kManyZeros * points) return "zero";
  if (static_cast<double>(lidar.at_largest) > kManyAtLargest * points) return "max";
  return "inf";
}

constexpr std::string_view kReturnsText =
    "# returns = \"first\"  # or \"strongest\" or \"last\": the echo that the lidar is set to report (docs/rig.md)\n";

constexpr std::string_view kSeveralText =
    "# the log has several echoes of a beam: the first of each is taken (docs/rosbag.md)\n";

/// The model where the log names it; else what to fill in. No log of single echoes tells which of them is reported.
std::string beam_text(const std::string& names, bool several_echoes) {
  const std::string_view model = model_in_name(names), returns = several_echoes ? kSeveralText : kReturnsText;
  if (!model.empty())
    return fmt::format("model = \"{}\"  # for the width of its beam; guessed from a name\n{}", model, returns);
  return fmt::format(
      "# model = \"{}\"  # for the width of its beam, which no log tells: one of {};\n"
      "# or beam_diameter_m and beam_divergence_rad from the sensor's data sheet\n{}",
      "LMS511", known_lidar_models(), returns);
}

std::string lidar_text(const LidarInfo& lidar, const std::string& frame_id) {
  const double min_m = lidar.range_min_m && std::isfinite(*lidar.range_min_m) && *lidar.range_min_m >= 0
                           ? std::max(*lidar.range_min_m, 0.01)
                           : 0.2;
  const bool stated = lidar.range_max_m && std::isfinite(*lidar.range_max_m) && *lidar.range_max_m > min_m;
  const double max_m = stated ? *lidar.range_max_m : std::max(1.0, std::ceil(lidar.largest_m));
  std::string text =
      fmt::format("[lidar]\ntopic = {}\nmin_range_m = {:.6g}\nmax_range_m = {:.6g}{}\nno_return = \"{}\"\n",
                  toml_quoted(lidar.topic), min_m, std::min(max_m, 1000.0),
                  stated ? "" : "  # the largest range in the log; take the sensor's data sheet", no_return_of(lidar));
  text += beam_text(frame_id + " " + lidar.topic, lidar.several_echoes > 0);
  const double zeros =
      100.0 * static_cast<double>(lidar.zero) / static_cast<double>(std::max<std::uint64_t>(1, lidar.points));
  const double infinite =
      100.0 * static_cast<double>(lidar.infinite) / static_cast<double>(std::max<std::uint64_t>(1, lidar.points));
  return text +
         fmt::format("# in the log: {:.1f} % of the ranges infinite, {:.1f} % zero, finite ones {:.3g} to {:.3g} m\n",
                     infinite, zeros, lidar.smallest_m, lidar.largest_m);
}

}  // namespace

std::string propose_rig(const LogInfo& info) {
  std::string text = "# Proposed from the log. Check it, and fill in how the sensors are mounted (docs/rig.md).\n";
  const LidarInfo* lidar = busiest(info, info.lidars);
  text += lidar != nullptr ? lidar_text(*lidar, frame_of(info, lidar->topic))
                           : "# [lidar]  the log has none that rayfield reads\n";
  // A spinner is a joint that goes round.
  const JointInfo* spinner = nullptr;
  for (const JointInfo& joint : info.joints) {
    if (!joint.turns()) continue;
    if (spinner == nullptr || joint.travelled_rad > spinner->travelled_rad) spinner = &joint;
  }
  if (spinner != nullptr) {
    text += fmt::format("\n[spinner]\ntopic = {}\njoint = {}\naxis = [0, 0, 1]  # in the spinner frame\n",
                        toml_quoted(spinner->topic), toml_quoted(spinner->joint));
  }
  const ImuInfo* imu = busiest(info, info.imus);
  text += imu != nullptr ? fmt::format("\n[imu]\ntopic = {}\n", toml_quoted(imu->topic))
                         : std::string("\n# [imu]  the log has none that rayfield reads\n");
  const GpsInfo* gps = busiest(info, info.gps);
  text += gps != nullptr ? fmt::format("\n[gps]\ntopic = {}\n", toml_quoted(gps->topic))
                         : std::string("\n# [gps]  the log has none: nothing can be georeferenced\n");
  text += "\n[extrinsics]  # target_from_source in metres, quaternions x y z w; remove the # and fill in\n";
  if (spinner != nullptr) {
    text += "# imu_from_spinner = { xyz = [0, 0, 0], q = [0, 0, 0, 1] }\n";
    text += "# spinner_from_lidar = { xyz = [0, 0, 0], q = [0, 0, 0, 1] }\n";
  } else {
    text += "# imu_from_lidar = { xyz = [0, 0, 0], q = [0, 0, 0, 1] }\n";
  }
  if (gps != nullptr) text += "# imu_from_gps = { xyz = [0, 0, 0] }\n";
  return text + "\n[time]\nlidar_offset_s = 0.0\ngps_offset_s = 0.0\n";
}

}  // namespace rayfield::formats
