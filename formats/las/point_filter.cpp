#include "formats/las/point_filter.h"

#include <cmath>

namespace rayfield::formats {

bool PointFilter::takes(const LasPoint& point) {
  std::uint64_t* reason = nullptr;
  if (!std::isfinite(point.gps_time_s))
    reason = &not_finite;
  else if (point.withheld)
    reason = &withheld;
  else if (point.synthetic)
    reason = &synthetic;
  else if (point.is_noise())
    reason = &noise;
  else if (point.return_number > 1)
    reason = &later_returns;
  if (reason != nullptr) ++*reason;
  return reason == nullptr;
}

std::vector<std::string> PointFilter::lines() const {
  std::vector<std::string> lines;
  say_left_out(later_returns, "that are later returns of their pulse", lines);
  say_left_out(withheld, "flagged as withheld", lines);
  say_left_out(synthetic, "flagged as synthetic", lines);
  say_left_out(noise, "classified as noise", lines);
  say_left_out(not_finite, "with NaN or infinite times", lines);
  return lines;
}

void say_left_out(std::uint64_t count, const char* what, std::vector<std::string>& lines) {
  if (count > 0) lines.push_back(std::to_string(count) + " points " + what + " left out");
}

}  // namespace rayfield::formats
