# One folder = one library: pagoda_library(name folder-sources...) with our warnings and include root.
find_package(PkgConfig REQUIRED)

add_library(pagoda_options INTERFACE)
target_compile_features(pagoda_options INTERFACE cxx_std_20)
target_compile_options(pagoda_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  # Bits must agree between compilers and dispatched paths: no fused multiply-add.
  -ffp-contract=off
  # Asserts name files from the repository's root, not the folder this was built in.
  -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=
  $<$<BOOL:${PAGODA_WERROR}>:-Werror>)

# pagoda_precompile(TARGET HEADERS...): what most of its sources include, parsed once. Of targets with
# few sources it would cost more than it saves.
set(pagoda_common_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
  <optional> <span> <string> <unordered_map> <unordered_set> <variant> <vector> <glm/glm.hpp> <fmt/format.h>)
function(pagoda_precompile target)
  get_target_property(sources ${target} SOURCES)
  list(LENGTH sources count)
  if(PAGODA_PCH AND count GREATER 7)
    target_precompile_headers(${target} PRIVATE ${pagoda_common_headers} ${ARGN})
  endif()
endfunction()

# pagoda_library(NAME SOURCES...): static library pagoda_NAME, alias Pagoda::NAME.
# A folder that is planned but still empty gets an empty source, so that it can be linked already.
function(pagoda_library name)
  set(sources ${ARGN})
  if(NOT sources)
    set(sources "${CMAKE_CURRENT_BINARY_DIR}/pagoda_${name}_empty.cpp")
    file(CONFIGURE OUTPUT "${sources}" CONTENT "// pagoda_${name} has no sources yet.\n")
  endif()
  add_library(pagoda_${name} STATIC ${sources})
  add_library(Pagoda::${name} ALIAS pagoda_${name})
  set_property(GLOBAL APPEND PROPERTY PAGODA_LIBRARIES ${name})
  target_include_directories(pagoda_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/pagoda>)
  target_link_libraries(pagoda_${name} PRIVATE $<BUILD_INTERFACE:pagoda_options>)
  target_compile_features(pagoda_${name} PUBLIC cxx_std_20)
  pagoda_precompile(pagoda_${name})
endfunction()
