# Benchmarks of the voxel traversal. Included by tests/bench/CMakeLists.txt.
find_package(benchmark REQUIRED)
add_executable(libdensity_bench ${CMAKE_CURRENT_LIST_DIR}/libdensity_bench.cpp
               ${CMAKE_CURRENT_LIST_DIR}/../libdensity/hedge_scene.cpp)
target_link_libraries(libdensity_bench PRIVATE rayfield::density benchmark::benchmark_main)
target_include_directories(libdensity_bench PRIVATE ${PROJECT_SOURCE_DIR})
rayfield_compile_settings(libdensity_bench)
