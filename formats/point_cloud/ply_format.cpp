#include "formats/point_cloud/ply_format.h"

#include <fmt/format.h>

#include <algorithm>

namespace rayfield::formats {
namespace {

constexpr std::size_t kCountDigits = 20;  // of 2^64

/// Whether a CRS fits into a comment: "EPSG:7854", and not WKT.
bool is_code(const std::string& crs) {
  return crs.size() <= 64 && std::all_of(crs.begin(), crs.end(), [](char c) { return c >= ' ' && c < 0x7f; });
}

class Ply : public PointFormat {
 public:
  explicit Ply(const PointCloudOptions& options) : options_(options) {}

  std::string header() const override {
    const std::string number = std::to_string(count);
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by " + options_.software;
    text.append(kCountDigits - number.size(), ' ');  // a padded comment keeps the header's length
    text += is_code(options_.crs) ? "\ncomment crs " + options_.crs + "\n" : "\n";
    text += "comment date " + options_.date + "\n";
    text += fmt::format("comment density m2/m3, in colours from {} to {}, grey where not known\n", options_.scale.low,
                        options_.scale.high);
    text += "element vertex " + number + "\n";
    for (const char* name : {"x", "y", "z"}) text += fmt::format("property double {}\n", name);
    for (const char* name : {"red", "green", "blue"}) text += fmt::format("property uchar {}\n", name);
    return text +
           "property float density\nproperty ushort intensity\nproperty uchar classification\nproperty double time\n"
           "end_header\n";
  }
  std::size_t record_bytes() const override {
    return 4 * sizeof(double) + 3 + sizeof(float) + sizeof(std::uint16_t) + 1;
  }

  Result<void> add(const DensityPoints& points, std::size_t i, const Rgba& color, std::vector<std::byte>& to) override {
    const Eigen::Vector3d& p = points.position[i];
    for (int k = 0; k < 3; ++k) append_number(to, p[k]);
    for (const std::uint8_t channel : {color.r, color.g, color.b}) append_number(to, channel);
    append_number(to, points.density[i]);
    append_number(to, points.intensity[i]);
    append_number(to, class_of(points.kind[i]));
    append_number(to, points.time_s[i]);
    ++count;
    return {};
  }

 private:
  PointCloudOptions options_;
};

}  // namespace

Result<std::unique_ptr<PointFormat>> make_ply_format(const PointCloudOptions& options) {
  return std::make_unique<Ply>(options);
}

}  // namespace rayfield::formats
