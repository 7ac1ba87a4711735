# Benchmarks of the tile store. Included by tests/bench/CMakeLists.txt.
find_package(benchmark REQUIRED)
add_executable(libtile_bench ${CMAKE_CURRENT_LIST_DIR}/libtile_bench.cpp)
target_link_libraries(libtile_bench PRIVATE rayfield::tile benchmark::benchmark_main)
target_include_directories(libtile_bench PRIVATE ${PROJECT_SOURCE_DIR})
rayfield_compile_settings(libtile_bench)
