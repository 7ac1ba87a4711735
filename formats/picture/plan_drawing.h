#pragma once

#include <string>

#include "formats/picture/picture_elements.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/picture.h"

namespace rayfield::formats {

/// A map with what lies over it, or (without a raster) the overlay alone.
struct Plan {
  const RasterProduct* raster = nullptr;
  const PlanOverlay& overlay;
  const PictureOptions& options;
  ColorScale scale;
  elements::BarEnds ends;
};

/// Draws and writes it. The options have been checked. Errors: as write_plan_picture().
Result<void> draw_plan(const Plan& plan, const std::string& path);

}  // namespace rayfield::formats
