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
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

# Link against mdk_defaults to get the house rules. A result must depend on the code alone, never
# on what the compiler chose to fuse: hence no -ffast-math, no -march, and no contraction.
add_library(mdk_defaults INTERFACE)
target_include_directories(mdk_defaults INTERFACE
  ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/common/include)
target_compile_features(mdk_defaults INTERFACE cxx_std_20)
target_compile_options(mdk_defaults INTERFACE
  -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -ffp-contract=off)
if(MDK_WARNINGS_AS_ERRORS)
  target_compile_options(mdk_defaults INTERFACE -Werror)
endif()
if(MDK_SANITIZE)
  target_compile_options(mdk_defaults INTERFACE
    -fsanitize=${MDK_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(mdk_defaults INTERFACE -fsanitize=${MDK_SANITIZE})
endif()
