# Voxel counting, estimators and integration; libdensity/CMakeLists.txt includes this file.
list(APPEND DENSITY_VOXEL_SOURCES
  src/element_size.cpp
  src/estimator.cpp
  src/integrate.cpp
  src/leaf_angle.cpp
  src/missing_rays.cpp
  src/plan_raster.cpp
  src/row_density.cpp
  src/row_fill.cpp
  src/slab_density.cpp
  src/tile_ground.cpp
  src/voxel_arrays.cpp
  src/voxel_grid.cpp
  src/voxel_index.cpp
  src/wood.cpp)
