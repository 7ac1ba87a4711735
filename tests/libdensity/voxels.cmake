# Tests of voxel counting, estimators and integration; included by CMakeLists.txt beside it.
rayfield_test(density_voxel_test LABEL unit
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/leaf_size_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/estimator_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/hedge_scene.cpp
          ${CMAKE_CURRENT_LIST_DIR}/integrate_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/leaf_angle_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/missing_rays_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/slab_density_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/voxel_arrays_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/voxel_grid_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/wood_test.cpp
  LINK rayfield::density)
rayfield_test(density_hedge_test LABEL slow
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/hedge_scene.cpp
          ${CMAKE_CURRENT_LIST_DIR}/row_density_test.cpp
  LINK rayfield::density)
