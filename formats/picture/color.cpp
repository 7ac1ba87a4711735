#include "formats/picture/color.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace rayfield::formats {
namespace {

using Stops = std::array<Rgba, 11>;

constexpr Stops stops(const std::array<std::uint32_t, 11>& rgb) {
  Stops out;
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    out[i] = {static_cast<std::uint8_t>(rgb[i] >> 16), static_cast<std::uint8_t>(rgb[i] >> 8),
              static_cast<std::uint8_t>(rgb[i])};
  }
  return out;
}

// Made in OKLCH (lightness, chroma and hue through chosen keys), sampled at equal CIE76 distances.
constexpr Stops kCanopyStops = stops(
    {0xfbf7e8, 0xfbefb6, 0xe8e27f, 0xa7ce5e, 0x66be66, 0x0daf7b, 0x079a8a, 0x077f8b, 0x015e82, 0x08417b, 0x1d1a5a});
constexpr Stops kHeightStops = stops(
    {0xfaf7e8, 0xf8f1c9, 0xf5e7a8, 0xf0d885, 0xe7c360, 0xd6a43f, 0xc28526, 0xad6716, 0x964d12, 0x7f3713, 0x672514});
constexpr Stops kUncertaintyStops = stops(
    {0xfbf6ee, 0xffe3cc, 0xffc9b1, 0xfeaf9e, 0xff9692, 0xf07e90, 0xd66a8f, 0xb8568a, 0x974080, 0x742871, 0x500b5d});
constexpr Stops kTerrainStops = stops(
    {0x0b4834, 0x225636, 0x3c6539, 0x56743d, 0x728344, 0x909451, 0xafa765, 0xc9ba80, 0xdecc9e, 0xefdebc, 0xfdf0dc});
constexpr Stops kChangeStops = stops(
    {0x672e16, 0x9c4e1c, 0xd6833b, 0xebb473, 0xf2daaf, 0xf5f3ee, 0xb4e8d5, 0x53cbc2, 0x009296, 0x00677d, 0x003c5f});

/// The smallest of 1, 2, 5 × 10ⁿ that is not below `value`.
double nice_above(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

}  // namespace

std::span<const Rgba> ramp_stops(Ramp ramp) {
  switch (ramp) {
    case Ramp::height:
      return kHeightStops;
    case Ramp::uncertainty:
      return kUncertaintyStops;
    case Ramp::terrain:
      return kTerrainStops;
    case Ramp::change:
      return kChangeStops;
    case Ramp::canopy:
      break;
  }
  return kCanopyStops;
}

Rgba color_at(const ColorScale& scale, double value) {
  if (std::isnan(value)) return {0, 0, 0, 0};
  const std::span<const Rgba> ramp = ramp_stops(scale.ramp);
  const double range = scale.high - scale.low;
  const double t = range > 0 ? std::clamp((value - scale.low) / range, 0.0, 1.0) : 0.0;
  const double position = t * static_cast<double>(ramp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(position), ramp.size() - 2);
  const double f = position - static_cast<double>(i);
  const auto mix = [f](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + f * (static_cast<double>(b) - a)));
  };
  return {mix(ramp[i].r, ramp[i + 1].r), mix(ramp[i].g, ramp[i + 1].g), mix(ramp[i].b, ramp[i + 1].b), 255};
}

ColorScale product_scale(std::string_view product, double data_low, double data_high) {
  if (product == "plan_density" || product == "leaf_density") return {0, 8, Ramp::canopy};
  if (product == "plan_density_se") return {0, 1, Ramp::uncertainty};
  if (product == "canopy_height") return {0, 3, Ramp::height};
  if (product == "leaf_area_per_m") return {0, 6, Ramp::canopy};
  if (product.starts_with("side_view") || product.starts_with("end_on")) return {0, 6, Ramp::canopy};
  if (product == "plan_density_change") return {-4, 4, Ramp::change};
  if (product == "canopy_height_change") return {-1, 1, Ramp::change};
  if (product == "leaf_change_per_m") return {-3, 3, Ramp::change};
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
