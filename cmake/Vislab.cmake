# Build rules of the lab: one function each to add a library of a layer, a culler family, a test and a
# benchmark.

option(VISLAB_TESTS "Build the tests" ON)
option(VISLAB_OPTIMISED_TESTS "Optimise the tests' own code as much as what they test" ON)
option(VISLAB_BENCHMARKS "Build the micro-benchmarks" ON)
option(VISLAB_PRECOMPILED_HEADERS "Read the headers that most files include only once" OFF)
option(VISLAB_WARNINGS_AS_ERRORS "Treat compiler warnings as errors" OFF)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}")

find_program(VISLAB_CCACHE ccache)
if(VISLAB_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${VISLAB_CCACHE}")
endif()

# Contraction of a*b+c into one rounding changes ids between builds: results must not depend on it.
add_library(vislab_options INTERFACE)
target_compile_options(vislab_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of overlapping copies in plain string concatenation (GCC bug 105651).
  target_compile_options(vislab_options INTERFACE -Wno-restrict)
endif()
if(VISLAB_WARNINGS_AS_ERRORS)
  target_compile_options(vislab_options INTERFACE -Werror)
endif()
target_include_directories(vislab_options INTERFACE "${PROJECT_SOURCE_DIR}")

# One precompiled header for all targets, of the system's headers only: what changes with the sources is
# not in it. A build without it (release) finds files that do not include what they use.
if(VISLAB_PRECOMPILED_HEADERS)
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/precompiled.cpp" CONTENT "")
  add_library(vislab_precompiled STATIC "${PROJECT_BINARY_DIR}/precompiled.cpp")
  target_link_libraries(vislab_precompiled PRIVATE vislab_options)
  target_precompile_headers(vislab_precompiled PRIVATE
    <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits> <map>
    <memory> <numbers> <numeric> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view>
    <unordered_map> <utility> <variant> <vector> <glm/glm.hpp> <glm/mat4x3.hpp>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(vislab_options INTERFACE -fpch-preprocess)  # for ccache
  endif()
endif()

# vislab_precompile(TARGET): lets a target use the precompiled header, if there is one.
function(vislab_precompile target)
  if(VISLAB_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM vislab_precompiled)
  endif()
endfunction()

# vislab_add_library(NAME SOURCES file... [PUBLIC library...] [PRIVATE library...])
# A static library vislab_NAME with the lab's options; PUBLIC libraries appear in its headers.
function(vislab_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(vislab_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(vislab_${name} PUBLIC ${ARG_PUBLIC} PRIVATE vislab_options ${ARG_PRIVATE})
  target_include_directories(vislab_${name} PUBLIC "${PROJECT_SOURCE_DIR}")
  vislab_precompile(vislab_${name})
endfunction()

# vislab_add_culler_family(FAMILY CULLERS name... [SOURCES file...] [LIBRARIES library...]
#                          [USES folder...] [USES_TRUTH])
# Adds the culler FAMILY.name for each name; its file is name.cpp, which defines
#   vislab::CullerEntry vislab::cullers::FAMILY_name();
# A family whose only culler bears its own name (none, oracle) is called by that name alone.
# SOURCES are files that several cullers of the family share. USES names folders of algorithms/ whose
# code the answers depend on too (for peers), so that what is mended there makes them stale.
# USES_TRUTH: the answers are the judge's (oracles), so that a mended judge does.
function(vislab_add_culler_family family)
  cmake_parse_arguments(ARG "USES_TRUTH" "" "CULLERS;SOURCES;LIBRARIES;USES" ${ARGN})
  set(files ${ARG_SOURCES})
  foreach(culler IN LISTS ARG_CULLERS)
    list(APPEND files ${culler}.cpp)
    if(culler STREQUAL family)
      set_property(GLOBAL APPEND PROPERTY VISLAB_CULLERS ${culler})
    else()
      set_property(GLOBAL APPEND PROPERTY VISLAB_CULLERS ${family}_${culler})
    endif()
  endforeach()
  vislab_add_library(${family} SOURCES ${files} PUBLIC vislab_culler PRIVATE ${ARG_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY VISLAB_CULLER_LIBRARIES vislab_${family})
  # With its folders, for the hash of its sources.
  get_filename_component(folders "${CMAKE_CURRENT_SOURCE_DIR}" NAME)
  list(APPEND folders ${ARG_USES})
  list(TRANSFORM folders PREPEND algorithms/)
  list(JOIN folders "+" folders)
  set_property(GLOBAL APPEND PROPERTY VISLAB_CULLER_FAMILIES "${family}:${folders}")
  if(ARG_USES_TRUTH)
    set_property(GLOBAL APPEND PROPERTY VISLAB_TRUTH_FAMILIES ${family})
  endif()
endfunction()

# vislab_write_registry(): the library vislab_cullers, whose register_all_cullers(Registry&) adds every
# culler of every family. To be called after all families.
function(vislab_write_registry)
  get_property(cullers GLOBAL PROPERTY VISLAB_CULLERS)
  get_property(libraries GLOBAL PROPERTY VISLAB_CULLER_LIBRARIES)
  set(declarations "")
  set(calls "")
  foreach(culler IN LISTS cullers)
    string(APPEND declarations "CullerEntry ${culler}();\n")
    string(APPEND calls "  registry.add(cullers::${culler}());\n")
  endforeach()
  set(file "${CMAKE_CURRENT_BINARY_DIR}/all_cullers.cpp")
  file(CONFIGURE OUTPUT "${file}" CONTENT
"// Written by CMake from the vislab_add_culler_family calls.
#include \"algorithms/all_cullers.h\"

namespace vislab::cullers {
@declarations@}  // namespace vislab::cullers

namespace vislab {
void register_all_cullers(Registry& registry) {
@calls@}
}  // namespace vislab
" @ONLY)
  vislab_add_library(cullers SOURCES "${file}" PUBLIC vislab_culler PRIVATE ${libraries})
endfunction()

# vislab_add_test(NAME SOURCES file... [LIBRARIES library...])
# A GoogleTest program test_NAME whose cases ctest knows one by one.
function(vislab_add_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  target_link_libraries(test_${name} PRIVATE vislab_options ${ARG_LIBRARIES} GTest::gtest_main)
  vislab_precompile(test_${name})
  if(NOT VISLAB_OPTIMISED_TESTS)
    target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  target_compile_definitions(test_${name} PRIVATE
    VISLAB_SOURCE_DIR="${PROJECT_SOURCE_DIR}" VISLAB_BINARY_DIR="${PROJECT_BINARY_DIR}")
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}" PROPERTIES TIMEOUT 600)
endfunction()

# vislab_add_benchmark(FAMILY SOURCES file... [LIBRARIES library...])
# A program bench_FAMILY, run by `./lab bench FAMILY`. Its main prints one JSON object a measurement
# (experiments/bench/bench.h).
function(vislab_add_benchmark family)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(bench_${family} ${ARG_SOURCES})
  target_link_libraries(bench_${family} PRIVATE vislab_options vislab_bench ${ARG_LIBRARIES})
endfunction()
