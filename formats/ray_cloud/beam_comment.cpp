#include "formats/ray_cloud/beam_comment.h"

#include <fmt/format.h>

#include <charconv>

namespace rayfield::formats {
namespace {

// Takes "key number" from the front of `text`, which stays as it is where that does not stand there.
std::optional<double> take_number(std::string_view key, double high, std::string_view& text) {
  if (!text.starts_with(key) || !text.substr(key.size()).starts_with(' ')) return std::nullopt;
  const std::string_view digits = text.substr(key.size() + 1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || !(value >= 0 && value <= high)) return std::nullopt;
  text = digits.substr(static_cast<std::size_t>(end - digits.data()));
  if (text.starts_with(' ')) text.remove_prefix(1);
  return value;
}

// Takes "returns strongest" likewise.
std::optional<ReturnMode> take_return_mode(std::string_view& text) {
  constexpr std::string_view kKey = "returns ";
  if (!text.starts_with(kKey)) return std::nullopt;
  const std::string_view name = text.substr(kKey.size(), text.find(' ', kKey.size()) - kKey.size());
  const auto mode = return_mode_named(name);
  if (!mode) return std::nullopt;
  text.remove_prefix(kKey.size() + name.size());
  if (text.starts_with(' ')) text.remove_prefix(1);
  return mode;
}

}  // namespace

std::string beam_comment(const LidarBeam& beam) {
  std::string text = fmt::format("beam diameter_m {} divergence_rad {}", beam.diameter_m, beam.divergence_rad);
  if (beam.detection_share) text += fmt::format(" detection_share {}", *beam.detection_share);
  if (beam.range_resolution_m) text += fmt::format(" range_resolution_m {}", *beam.range_resolution_m);
  if (beam.returns) text += fmt::format(" returns {}", name_of(*beam.returns));
  return text;
}

std::optional<LidarBeam> parse_beam_comment(std::string_view comment) {
  if (!comment.starts_with("beam ")) return std::nullopt;
  std::string_view rest = comment.substr(5);
  const auto diameter = take_number("diameter_m", kWidestBeam_m, rest);
  const auto divergence = take_number("divergence_rad", kWidestDivergence_rad, rest);
  if (!diameter || !divergence) return std::nullopt;
  LidarBeam beam{.diameter_m = *diameter, .divergence_rad = *divergence};
  beam.detection_share = take_number("detection_share", 1, rest);
  beam.range_resolution_m = take_number("range_resolution_m", kCoarsestRange_m, rest);
  beam.returns = take_return_mode(rest);
  const bool is_resolution = beam.range_resolution_m.value_or(kFinestRange_m) >= kFinestRange_m;
  if (!rest.empty() || beam.detection_share == 0 || !is_resolution) return std::nullopt;
  return beam;
}

}  // namespace rayfield::formats
