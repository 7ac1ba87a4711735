# rayfield_room(<name> SUBROOMS <folder>... SOURCES ... [USES <room>...] [PUBLIC <lib>...] [PRIVATE <lib>...])
#
# One static library per room, `rayfield_<name>`, exported as `rayfield::<name>`.
# A room may only link the rooms that the table below allows; anything else stops the configure step. SUBROOMS are the
# room's folders from the ground up.
set(RAYFIELD_MAY_USE_core "")
set(RAYFIELD_MAY_USE_slam "core")
set(RAYFIELD_MAY_USE_tile "core")
set(RAYFIELD_MAY_USE_density "core;tile")
set(RAYFIELD_MAY_USE_formats "core")
set(RAYFIELD_MAY_USE_sim "core")

set(RAYFIELD_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
    -Wcast-qual -Wconversion -Wno-sign-conversion -Wdouble-promotion -Wformat=2
    -Wno-missing-field-initializers)  # members left out of an initialiser have defaults, on purpose
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND RAYFIELD_WARNINGS -Wno-restrict)  # false alarms on std::string operator+ in GCC 12 (PR 105651)
endif()

function(rayfield_compile_settings target)
  # Contraction changes results between compilers and targets; see docs/determinism.md.
  target_compile_options(${target} PRIVATE ${RAYFIELD_WARNINGS} -ffp-contract=off)
  if(RAYFIELD_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(RAYFIELD_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${RAYFIELD_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${RAYFIELD_SANITIZE})
  endif()
endfunction()

function(rayfield_room name)
  cmake_parse_arguments(ARG "" "" "SUBROOMS;SOURCES;USES;PUBLIC;PRIVATE" ${ARGN})
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
