#include "formats/vehicle/lidar_models.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace rayfield::formats {
namespace {

struct LidarModel {
  std::string_view name;
  LidarBeam beam;
};

// Their usual setting. A VLP-16 can report the strongest, the last or both, not the first.
constexpr auto kStrongest = ReturnMode::strongest;

// Elliptical beams by their geometric mean: VLP-16 12.7 × 9.5 mm and 3.0 × 1.5 mrad, HDL-32E 3.0 × 1.2 mrad, Livox
// 0.28° × 0.03°. Ouster states full widths at half maximum: 0.35°, 0.18° and 0.09°.
constexpr std::array<LidarModel, 10> kModels{{
    {"LMS511", {0.0136, 0.0119, {}, {}, {}}},
    {"LMS111", {0.008, 0.015, {}, {}, {}}},
    {"LMS200", {0.012, 0.0044, {}, {}, {}}},
    {"VLP16", {0.011, 0.0021, {}, {}, kStrongest}},
    {"HDL32E", {0.011, 0.0019, {}, {}, kStrongest}},
    {"OS0", {0.005, 0.0061, {}, {}, kStrongest}},
    {"OS1", {0.0095, 0.0031, {}, {}, kStrongest}},
    {"OS2", {0.0225, 0.0016, {}, {}, kStrongest}},
    {"MID40", {0.010, 0.0016, {}, {}, {}}},
    {"MID70", {0.010, 0.0016, {}, {}, {}}},
}};

// What is left of a name: capital letters and digits.
std::string key_of(std::string_view name) {
  std::string key;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      key += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return key;
}

}  // namespace

const LidarBeam* beam_of_model(std::string_view model) {
  std::string key = key_of(model);
  for (const std::string_view maker : {"SICK", "VELODYNE", "OUSTER", "LIVOX"})
    if (key.starts_with(maker)) key.erase(0, maker.size());
  const auto found = std::find_if(kModels.begin(), kModels.end(), [&](const LidarModel& m) { return m.name == key; });
  return found == kModels.end() ? nullptr : &found->beam;
}

std::string known_lidar_models() {
  std::string all;
  for (const LidarModel& model : kModels) all += (all.empty() ? "" : ", ") + std::string(model.name);
  return all;
}

std::string_view model_in_name(std::string_view name) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (i > 0 && letter(name[i - 1])) continue;  // within a word: "/lidar_pos0" is not an OS0
    const std::string key = key_of(name.substr(i));
    for (const LidarModel& model : kModels)
      if (key.starts_with(model.name)) return model.name;
  }
  return {};
}

}  // namespace rayfield::formats
