# How every target of the project is made: one language level, one set of warnings, one output folder,
# and a check that each header compiles alone.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo)
endif()

# ccache, when it is there, makes a second build of the generated gRPC code free.
find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# mold, when it is there, links in a tenth of the time. What is delivered is linked by the system's linker.
find_program(MOLD mold)
if(MOLD)
  add_link_options($<$<NOT:$<CONFIG:Release>>:-fuse-ld=mold>)
endif()

add_library(lpv_warnings INTERFACE)
target_compile_options(lpv_warnings INTERFACE
  -Wall -Wextra -Wpedantic $<$<BOOL:${LPV_WARNINGS_ARE_ERRORS}>:-Werror> -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wimplicit-fallthrough
  # Pair tests must give the same bits on both sides of the GPU: no fused multiply-add behind our back.
  -ffp-contract=off
  # GCC 12 at -O3 sees overlapping copies in string concatenation where there are none (its bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Wno-restrict>)
if(LPV_SANITIZE)
  # GCC sees values as possibly unset where a sanitizer's checks stand between setting and use.
  target_compile_options(lpv_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_compile_options(lpv_warnings INTERFACE -fsanitize=${LPV_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(lpv_warnings INTERFACE -fsanitize=${LPV_SANITIZE})
endif()

# lpv_library(NAME DIR FILES...): a static library of one folder. Headers are included from the folder's parent
# ("scene/grid.h"), so that the path says which layer is used. FOLDERS: where the headers are, if not only here.
function(lpv_library name)
  cmake_parse_arguments(ARG "" "ROOT" "SOURCES;PUBLIC;PRIVATE;FOLDERS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  if(NOT ARG_ROOT)
    set(ARG_ROOT ${PROJECT_SOURCE_DIR}/server)
  endif()
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${ARG_ROOT}>)
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:lpv_warnings>)
  lpv_headers_compile_alone(${name} FOLDERS ${ARG_FOLDERS})
endfunction()

# lpv_mostly_headers(TARGETS...): targets whose sources take their compile time from gRPC's, GoogleTest's, CLI11's or
# GLM's headers. With LPV_UNITY eight sources are compiled as one: half the time for all, a
# little more for one that was edited. Builds without it (release, tests/run --long) see that each compiles alone.
function(lpv_mostly_headers)
  if(LPV_UNITY)
    set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    foreach(target ${ARGN})
      # "The whole file is anonymous" is only true of the joined one.
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    endforeach()
  endif()
endfunction()

# lpv_plain_under_sanitizers(TARGETS...): targets that are glue between large libraries. Clang takes twice as long to optimise
# what their templates become under sanitizers, and tests of them are no slower without.
function(lpv_plain_under_sanitizers)
  if(LPV_SANITIZE)
    foreach(target ${ARGN})
      target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O0>)
    endforeach()
  endif()
endfunction()

# lpv_headers_compile_alone(NAME [FOLDERS ...]): every header of the current folder, or of those folders below it, is
# compiled as a translation unit of its own.
function(lpv_headers_compile_alone name)
  cmake_parse_arguments(ARG "" "" "FOLDERS" ${ARGN})
  list(TRANSFORM ARG_FOLDERS PREPEND "/")
  if(NOT ARG_FOLDERS)
    set(ARG_FOLDERS "/.")
  endif()
  list(TRANSFORM ARG_FOLDERS REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}\\1/*.h")
  file(GLOB headers CONFIGURE_DEPENDS ${ARG_FOLDERS})
  set(units)
  foreach(header ${headers})
    file(RELATIVE_PATH unit ${CMAKE_CURRENT_SOURCE_DIR} ${header})
    set(unit ${CMAKE_CURRENT_BINARY_DIR}/headers/${unit}.cpp)
    file(CONFIGURE OUTPUT ${unit} CONTENT "#include \"${header}\"  // IWYU pragma: keep\n")
    list(APPEND units ${unit})
  endforeach()
  if(units AND LPV_BUILD_TESTS)
    add_library(${name}_headers OBJECT EXCLUDE_FROM_ALL ${units})
    target_link_libraries(${name}_headers PRIVATE ${name} lpv_warnings)
    if(NOT TARGET headers)
      add_custom_target(headers COMMENT "Every header compiles alone")
    endif()
    add_dependencies(headers ${name}_headers)
  endif()
endfunction()
