#include "cli/console/beam_text.h"

#include <fmt/core.h>

namespace rayfield::cli {

std::string beam_text(const LidarBeam& beam) {
  std::string text = fmt::format("{:.3g} mm + {:.3g} mrad", 1e3 * beam.diameter_m, 1e3 * beam.divergence_rad);
  if (beam.detection_share) text += fmt::format(", returns from {:.3g} of its energy on leaves", *beam.detection_share);
  if (beam.range_resolution_m) text += fmt::format(", resolves {:.3g} m in range", *beam.range_resolution_m);
  if (beam.returns) text += fmt::format(", reports the {} echo", name_of(*beam.returns));
  return text;
}

nlohmann::ordered_json beam_json(const LidarBeam& beam) {
  nlohmann::ordered_json json = {{"diameter_m", beam.diameter_m}, {"divergence_rad", beam.divergence_rad}};
  if (beam.detection_share) json["detection_share"] = *beam.detection_share;
  if (beam.range_resolution_m) json["range_resolution_m"] = *beam.range_resolution_m;
  if (beam.returns) json["returns"] = name_of(*beam.returns);
  return json;
}

}  // namespace rayfield::cli
