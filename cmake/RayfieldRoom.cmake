# rayfield_room(<name> SUBROOMS <folder>... SOURCES ... [USES <room>...] [PUBLIC <lib>...] [PRIVATE <lib>...])
#
# One static library per room, `rayfield_<name>`, exported as `rayfield::<name>`.
# A room may only link the rooms that the table below allows; anything else stops the configure step. SUBROOMS are the
# room's folders from the ground up (see rayfield_check_subrooms).
set(RAYFIELD_MAY_USE_core "")
set(RAYFIELD_MAY_USE_slam "core")
set(RAYFIELD_MAY_USE_tile "core")
set(RAYFIELD_MAY_USE_align "core")
set(RAYFIELD_MAY_USE_density "core;tile")
set(RAYFIELD_MAY_USE_formats "core")
set(RAYFIELD_MAY_USE_sim "core")
set(RAYFIELD_MAY_USE_experiments "core;density;sim")

set(RAYFIELD_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
    -Wcast-qual -Wconversion -Wno-sign-conversion -Wdouble-promotion -Wformat=2
    -Wno-missing-field-initializers)  # members left out of an initialiser have defaults, on purpose
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND RAYFIELD_WARNINGS -Wno-restrict)  # false alarms on std::string operator+ in GCC 12 (PR 105651)
endif()

function(rayfield_compile_settings target)
  # Contraction changes results between compilers and targets; see docs/architecture.md, "Determinism".
  target_compile_options(${target} PRIVATE ${RAYFIELD_WARNINGS} -ffp-contract=off)
  if(RAYFIELD_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(RAYFIELD_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${RAYFIELD_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${RAYFIELD_SANITIZE})
    # Under AddressSanitizer Eigen would align memory itself, which Ceres, compiled without, then frees as malloc's.
    target_compile_definitions(${target} PUBLIC EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
endfunction()

# rayfield_check_subrooms(<folder of the room> <folder of its public headers or ""> <sub-room>...)
#
# Sub-rooms are ordered from the ground up: a file may include private headers of its own sub-room and of those before
# it. An include that runs back up, or into another room's private headers, stops the configure step, as does a source in
# no sub-room. A public header belongs to the sub-room that holds the source of its name; one without a source is
# vocabulary and open to all.
function(rayfield_check_subrooms folder public)
  get_filename_component(room ${folder} NAME)
  set(subrooms ${ARGN})
  file(GLOB_RECURSE files RELATIVE ${folder} ${folder}/*.h ${folder}/*.cpp)
  foreach(file IN LISTS files)  # which sub-room holds the source of a public header
    get_filename_component(stem ${file} NAME_WE)
    string(REGEX REPLACE "/.*" "" subroom ${file})
    if(file MATCHES "/.*\\.cpp$")
      set(subroom_of_${stem} ${subroom})
    endif()
  endforeach()
  foreach(file IN LISTS files)
    get_filename_component(stem ${file} NAME_WE)
    string(REGEX REPLACE "/.*" "" subroom ${file})
    if(subroom STREQUAL "include")
      set(subroom "${subroom_of_${stem}}")
    elseif(NOT file MATCHES "/")
      continue()  # the room's own face, on top of all sub-rooms
    elseif(NOT subroom IN_LIST subrooms)
      message(FATAL_ERROR "${room}/${file} lies in no sub-room of ${room}/CMakeLists.txt: ${subrooms}")
    endif()
    list(FIND subrooms "${subroom}" floor)
    file(STRINGS ${folder}/${file} includes REGEX "^#include \"")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" include "${include}")
      set(other "")
      if(include MATCHES "^rayfield/${public}/([a-z0-9_]+)\\.h$" AND NOT public STREQUAL "")
        set(other "${subroom_of_${CMAKE_MATCH_1}}")
      elseif(include MATCHES "^${room}/([a-z0-9_]+)/")
        set(other ${CMAKE_MATCH_1})
        if(file MATCHES "^include/")
          message(FATAL_ERROR "${room}/${file}: a public header includes the private ${include}")
        endif()
      elseif(NOT include MATCHES "^rayfield/" AND include MATCHES "/")
        message(FATAL_ERROR "${room}/${file} includes ${include}, which is private to another room")
      endif()
      list(FIND subrooms "${other}" other_floor)
      if(floor GREATER -1 AND other_floor GREATER floor)
        message(FATAL_ERROR "${room}/${file} includes ${include}: '${other}' stands above '${subroom}' (${subrooms})")
      endif()
    endforeach()
  endforeach()
endfunction()

function(rayfield_room name)
  cmake_parse_arguments(ARG "" "" "SUBROOMS;SOURCES;USES;PUBLIC;PRIVATE" ${ARGN})
  rayfield_check_subrooms(${CMAKE_CURRENT_SOURCE_DIR} ${name} ${ARG_SUBROOMS})
  foreach(used IN LISTS ARG_USES)
    if(NOT used IN_LIST RAYFIELD_MAY_USE_${name})
      message(FATAL_ERROR "room '${name}' may not use room '${used}' (cmake/RayfieldRoom.cmake)")
    endif()
  endforeach()
  set(target rayfield_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(rayfield::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR})
  foreach(used IN LISTS ARG_USES)
    target_link_libraries(${target} PUBLIC rayfield_${used})
  endforeach()
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  rayfield_compile_settings(${target})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(TARGETS ${target} EXPORT rayfieldTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

# rayfield_test(<name> LABEL unit|slow SOURCES ... LINK ...): one GoogleTest executable.
function(rayfield_test name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})  # private headers are tested too
  rayfield_compile_settings(${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS ${ARG_LABEL} TIMEOUT 900)
endfunction()
