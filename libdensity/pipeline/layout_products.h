#pragma once

#include <string>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"

namespace rayfield::density {

/// Identities: named UUIDs of the geometry in the layout, so that the same block gets the same ones on every machine.
/// They stay for as long as the layout is kept, which is for ever unless the user asks for a new one.
std::string row_uid(const Row& row, const std::string& crs);
std::string panel_uid(const Panel& panel, const RowLayout& layout, const std::string& crs);
std::string post_uid(const Post& post, const std::string& crs);

/// The layout as products. `half_width_m`: of the panels' outlines, about the canopy's. `ground` may lack places: the
/// height is NaN there.
BlockProducts layout_products(const RowLayout& layout, const std::string& block, const std::string& crs,
                              const GroundModel& ground, double half_width_m);

}  // namespace rayfield::density
