# GIS products and pictures: GeoTIFF, GeoPackage, exchange files (GDAL) and PNG (Cairo). Included by CMakeLists.txt.
find_package(GDAL CONFIG REQUIRED)
find_path(CAIRO_INCLUDE_DIR cairo.h PATH_SUFFIXES cairo REQUIRED)
find_library(CAIRO_LIBRARY cairo REQUIRED)
include_directories(SYSTEM ${CAIRO_INCLUDE_DIR})

set(FORMATS_GIS_SOURCES
  src/color.cpp src/text_escape.cpp src/staged_output.cpp src/gdal_session.cpp src/qml.cpp
  src/raster_statistics.cpp src/geotiff.cpp
  src/canvas.cpp src/render_grid.cpp src/picture_parts.cpp src/picture_plan.cpp src/picture_section.cpp
  src/gpkg_schema.cpp src/gpkg_layers.cpp src/gpkg_finish.cpp src/geopackage.cpp src/exchange.cpp)
set(FORMATS_GIS_LIBRARIES GDAL::GDAL ${CAIRO_LIBRARY})
set(FORMATS_GIS_LIBS ${FORMATS_GIS_LIBRARIES})
