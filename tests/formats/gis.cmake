# GIS products and pictures. GDAL reads back what the writers wrote; its validators run through the system's Python.
find_package(GDAL CONFIG REQUIRED)
foreach(name geotiff geopackage picture exchange color publish)
  rayfield_test(formats_gis_${name}_test LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/gis_${name}_test.cpp
                LINK rayfield::formats GDAL::GDAL)
endforeach()
