#pragma once

#include <cstddef>
#include <string>

namespace rayfield::test {

/// A cloud of `count` rays that go down from 2 m above a moving vehicle.
inline std::string lane_cloud(std::size_t count, const std::string& format = "binary_little_endian", bool starts = true,
                              double east_m = 500000, double north_m = 5200000) {
  std::string text = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) +
                     "\nproperty double x\nproperty double y\nproperty double z\nproperty double time\n";
  if (starts) text += "property float nx\nproperty float ny\nproperty float nz\n";
  text += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nend_header\n";
  for (std::size_t i = 0; i < count; ++i) {
    const double row[4] = {east_m + 0.01 * static_cast<double>(i), north_m, 100.0,
                           1.6e9 + 0.001 * static_cast<double>(i)};
    const float start[3] = {0, 0, 2};
    text.append(reinterpret_cast<const char*>(row), sizeof(row));
    if (starts) text.append(reinterpret_cast<const char*>(start), sizeof(start));
    text.append("\x80\x80\x80\xff", 4);
  }
  return text;
}

}  // namespace rayfield::test
