#pragma once

#include <span>
#include <string>

#include "formats/qgis/project.h"
#include "rayfield/core/products.h"
#include "rayfield/formats/qgis_project.h"

namespace rayfield::formats::qgis {

/// A block in QGIS: rows, posts and panel outlines with their numbers; below them one group per date, the newest first
/// and alone shown, with panels, half metres and the maps of that date; for the temporal controller one group of
/// panels and one of maps with all dates; tables. `file_name`: of the GeoPackage; maps lie beside it. The coordinate
/// reference system is left open.
Project block_project(const BlockProducts& block, const ColorScale& panel_scale, std::span<const ProjectMap> maps,
                      const std::string& file_name);

}  // namespace rayfield::formats::qgis
