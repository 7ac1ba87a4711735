#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/formats/style.h"

namespace rayfield::formats {

std::span<const Rgba> ramp_stops(Ramp ramp);

/// The colour of a value; NaN is fully transparent.
Rgba color_at(const ColorScale& scale, double value);

/// The scale of a product by its name:
///   plan_density     0 … 8 m²/m²   canopy        side_view*, end_on*  0 … 6 m²/m²  canopy
///   plan_density_se  0 … 1 m²/m²   uncertainty   leaf_area_per_m      0 … 6 m²/m   canopy
///   canopy_height    0 … 3 m       height        ground               data, whole metres outward, terrain
///   plan_density_change  −4 … 4 m²/m²   canopy_height_change  −1 … 1 m   leaf_change_per_m  −3 … 3 m²/m   change
/// Other names: 0 (or the rounded minimum, if negative) … the rounded maximum of the data, canopy.
/// `data_low`, `data_high`: range of the data, used where the product has no fixed scale; NaN = no data.
ColorScale product_scale(std::string_view product, double data_low, double data_high);

/// `count` + 1 values or fewer from low to high at steps of 1, 2 or 5 × 10ⁿ, for ticks and legends.
std::vector<double> nice_ticks(double low, double high, int count);

/// A tick value as text, without digits that the step does not carry.
std::string tick_text(double value, double step);

/// "m2/m2" → "m²/m²".
std::string pretty_unit(std::string_view unit);

/// "#rrggbb".
std::string hex_text(const Rgba& color);

}  // namespace rayfield::formats
