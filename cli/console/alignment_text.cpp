#include "cli/console/alignment_text.h"

#include <fmt/core.h>

#include <cmath>

namespace rayfield::cli {

std::string alignment_text(const tile::ScanAlignment& a) {
  if (a.verdict == tile::AlignmentVerdict::reference) return "the block's reference";
  if (a.verdict == tile::AlignmentVerdict::unaligned) return "not aligned: it lies where its GPS puts it";
  return fmt::format(
      "aligned: moved {:+.2f} m east, {:+.2f} m north, {:+.2f} m up, turned {:+.1f} mrad{}; {} posts and trunks fit to "
      "{:.1f} cm",
      a.offset_m.x(), a.offset_m.y(), a.offset_m.z(), 1e3 * a.yaw_rad,
      a.warp_rms_m > 0 ? fmt::format(", bent by {:.1f} cm", 100 * a.warp_rms_m) : "", a.landmarks, 100 * a.residual_m);
}

nlohmann::ordered_json alignment_json(const tile::ScanAlignment& a) {
  nlohmann::ordered_json json = {{"verdict", tile::verdict_name(a.verdict)},
                                 {"aligned", a.verdict != tile::AlignmentVerdict::unaligned},
                                 {"offset_e_m", a.offset_m.x()},
                                 {"offset_n_m", a.offset_m.y()},
                                 {"offset_h_m", a.offset_m.z()},
                                 {"yaw_mrad", 1e3 * a.yaw_rad},
                                 {"landmarks", a.landmarks}};
  if (a.verdict != tile::AlignmentVerdict::aligned) return json;
  json["residual_m"] = a.residual_m;
  json["ground_residual_m"] =
      std::isfinite(a.ground_residual_m) ? nlohmann::ordered_json(a.ground_residual_m) : nullptr;
  json["warp_rms_m"] = a.warp_rms_m;
  json["shared_fraction"] = a.shared_fraction;
  json["margin"] = std::isfinite(a.margin) ? nlohmann::ordered_json(a.margin) : nullptr;
  return json;
}

}  // namespace rayfield::cli
