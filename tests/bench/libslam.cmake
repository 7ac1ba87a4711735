# Benchmarks of SLAM by stage. Included by tests/bench/CMakeLists.txt.
find_package(benchmark REQUIRED)
find_package(Ceres REQUIRED)
add_executable(libslam_bench ${CMAKE_CURRENT_LIST_DIR}/libslam_bench.cpp)
target_link_libraries(libslam_bench PRIVATE rayfield::slam Ceres::ceres benchmark::benchmark_main)
target_include_directories(libslam_bench PRIVATE ${PROJECT_SOURCE_DIR})
rayfield_compile_settings(libslam_bench)
