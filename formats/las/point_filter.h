#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/las/las_point.h"

namespace rayfield::formats {

/// Which points of a LAS file are ends of rays, and how many are not, each counted for the first reason that it has.
struct PointFilter {
  std::uint64_t not_finite = 0, withheld = 0, synthetic = 0, noise = 0, later_returns = 0;

  /// A pulse is one ray, up to its first return. Writers that know no returns leave their number at 0.
  bool takes(const LasPoint& point);
  /// What was left out, a line each.
  std::vector<std::string> lines() const;
};

/// Appends "12 points WHAT left out" where there are any.
void say_left_out(std::uint64_t count, const char* what, std::vector<std::string>& lines);

}  // namespace rayfield::formats
