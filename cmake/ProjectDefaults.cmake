# What every target of the project shares: language level, warnings, reproducible
# floating point, sanitizers, ccache, and one place for the programs.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache keeps files with precompiled headers only where it is told that they may differ in time.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()

# Link against mdk_defaults to get the house rules. A result must depend on the code alone, never
# on what the compiler chose to fuse: hence no -ffast-math, no -march, and no contraction.
add_library(mdk_defaults INTERFACE)
target_include_directories(mdk_defaults INTERFACE
  ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/common/include)
target_compile_features(mdk_defaults INTERFACE cxx_std_20)
target_compile_options(mdk_defaults INTERFACE
  -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -ffp-contract=off)
# Highway compiles each kernel for every instruction set; no processor of today stops at SSSE3.
target_compile_definitions(mdk_defaults INTERFACE HWY_DISABLED_TARGETS=HWY_SSSE3)
if(MDK_WARNINGS_AS_ERRORS)
  target_compile_options(mdk_defaults INTERFACE -Werror)
endif()
if(MDK_SANITIZE)
  target_compile_options(mdk_defaults INTERFACE
    -fsanitize=${MDK_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(mdk_defaults INTERFACE -fsanitize=${MDK_SANITIZE})
endif()

# The standard headers that nearly all files include, precompiled once: a fifth of the compile time.
# A file still includes what it uses.
option(MDK_PRECOMPILE "Precompile the standard headers" ON)
set(MDK_STANDARD_HEADERS
  <algorithm> <array> <atomic> <cmath> <cstddef> <cstdint> <cstring> <functional>
  <limits> <map> <memory> <mutex> <optional> <span> <stdexcept> <string> <string_view> <utility>
  <vector>)
if(MDK_PRECOMPILE)
  file(WRITE ${CMAKE_BINARY_DIR}/standard_headers.cpp "// Owns the precompiled headers.\n")
  add_library(mdk_standard_headers STATIC ${CMAKE_BINARY_DIR}/standard_headers.cpp)
  target_link_libraries(mdk_standard_headers PRIVATE mdk_defaults)
  target_compile_options(mdk_defaults INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)  # for ccache
  target_precompile_headers(mdk_standard_headers PRIVATE ${MDK_STANDARD_HEADERS})
endif()

# mdk_precompile(TARGET…): libraries that take the precompiled headers.
function(mdk_precompile)
  if(MDK_PRECOMPILE)
    foreach(target IN LISTS ARGN)
      target_precompile_headers(${target} REUSE_FROM mdk_standard_headers)
    endforeach()
  endif()
endfunction()

# mdk_optimize_lightly(TARGET…): what waits for people and files, not for the processor, so that
# compiling it well costs more than it gives.
function(mdk_optimize_lightly)
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endforeach()
endfunction()
