#include "rayfield/formats/color.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rayfield::formats {
namespace {

using Stops = std::array<Rgba, 11>;

// Made in OKLCH (lightness, chroma and hue through chosen keys), sampled at equal CIE76 distances.
constexpr Stops canopy_stops = {{{251, 247, 232},
                                 {251, 239, 182},
                                 {232, 226, 127},
                                 {167, 206, 94},
                                 {102, 190, 102},
                                 {13, 175, 123},
                                 {7, 154, 138},
                                 {7, 127, 139},
                                 {1, 94, 130},
                                 {8, 65, 123},
                                 {29, 26, 90}}};
constexpr Stops height_stops = {{{250, 247, 232},
                                 {248, 241, 201},
                                 {245, 231, 168},
                                 {240, 216, 133},
                                 {231, 195, 96},
                                 {214, 164, 63},
                                 {194, 133, 38},
                                 {173, 103, 22},
                                 {150, 77, 18},
                                 {127, 55, 19},
                                 {103, 37, 20}}};
constexpr Stops uncertainty_stops = {{{251, 246, 238},
                                      {255, 227, 204},
                                      {255, 201, 177},
                                      {254, 175, 158},
                                      {255, 150, 146},
                                      {240, 126, 144},
                                      {214, 106, 143},
                                      {184, 86, 138},
                                      {151, 64, 128},
                                      {116, 40, 113},
                                      {80, 11, 93}}};
constexpr Stops terrain_stops = {{{11, 72, 52},
                                  {34, 86, 54},
                                  {60, 101, 57},
                                  {86, 116, 61},
                                  {114, 131, 68},
                                  {144, 148, 81},
                                  {175, 167, 101},
                                  {201, 186, 128},
                                  {222, 204, 158},
                                  {239, 222, 188},
                                  {253, 240, 220}}};

/// The smallest of 1, 2, 5 × 10ⁿ that is not below `value`.
double nice_above(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

bool starts_with(std::string_view text, std::string_view prefix) { return text.substr(0, prefix.size()) == prefix; }

}  // namespace

std::span<const Rgba> ramp_stops(Ramp ramp) {
  switch (ramp) {
    case Ramp::height:
      return height_stops;
    case Ramp::uncertainty:
      return uncertainty_stops;
    case Ramp::terrain:
      return terrain_stops;
    case Ramp::canopy:
      break;
  }
  return canopy_stops;
}

Rgba color_at(const ColorScale& scale, double value) {
  if (std::isnan(value)) return {0, 0, 0, 0};
  const std::span<const Rgba> stops = ramp_stops(scale.ramp);
  const double range = scale.high - scale.low;
  const double t = range > 0 ? std::clamp((value - scale.low) / range, 0.0, 1.0) : 0.0;
  const double position = t * static_cast<double>(stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(position), stops.size() - 2);
  const double f = position - static_cast<double>(i);
  const auto mix = [f](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + f * (static_cast<double>(b) - a)));
  };
  return {mix(stops[i].r, stops[i + 1].r), mix(stops[i].g, stops[i + 1].g), mix(stops[i].b, stops[i + 1].b), 255};
}

ColorScale product_scale(std::string_view product, double data_low, double data_high) {
  if (product == "plan_density") return {0, 8, Ramp::canopy};
  if (product == "plan_density_se") return {0, 1, Ramp::uncertainty};
  if (product == "canopy_height") return {0, 3, Ramp::height};
  if (product == "leaf_area_per_m") return {0, 6, Ramp::canopy};
  if (starts_with(product, "side_view") || starts_with(product, "end_on")) return {0, 6, Ramp::canopy};
  const bool known = std::isfinite(data_low) && std::isfinite(data_high) && data_low <= data_high;
  if (product == "ground") {
    if (!known) return {0, 1, Ramp::terrain};
    const double low = std::floor(data_low);
    return {low, std::max(std::ceil(data_high), low + 1), Ramp::terrain};
  }
  if (!known) return {0, 1, Ramp::canopy};
  const double low = data_low < 0 ? -nice_above(-data_low) : 0.0;
  return {low, data_high > 0 ? nice_above(data_high) : (low < 0 ? 0.0 : 1.0), Ramp::canopy};
}

std::vector<double> nice_ticks(double low, double high, int count) {
  std::vector<double> ticks;
  if (!(high > low) || count < 1 || !std::isfinite(low) || !std::isfinite(high)) return ticks;
  const double step = nice_above((high - low) / count), slack = 1e-9 * step;
  const double first = std::ceil((low - slack) / step);
  // Counted, because first + 1 may equal first where the range is tiny against its distance from zero.
  for (int i = 0; i <= count + 1 && (first + i) * step <= high + slack; ++i) ticks.push_back((first + i) * step);
  return ticks;
}

std::string tick_text(double value, double step) {
  const int digits = step > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9) : 0;
  const std::string text = fmt::format("{:.{}f}", value, digits);
  // −0 arises from ticks computed as k · step.
  return text.find_first_not_of("-0.") == std::string::npos && text.front() == '-' ? text.substr(1) : text;
}

std::string pretty_unit(std::string_view unit) {
  std::string out;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const bool exponent = i > 0 && (unit[i] == '2' || unit[i] == '3') && unit[i - 1] == 'm';
    out += exponent ? (unit[i] == '2' ? "²" : "³") : std::string(1, unit[i]);
  }
  return out;
}

std::string hex_text(const Rgba& color) { return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b); }

}  // namespace rayfield::formats
