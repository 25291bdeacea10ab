# Measures that make a first build short: headers that many sources include are read once and kept precompiled, and sources are compiled
# several at a time: what they share (headers, templates) takes most of the compiler's time. No source relies on either: each includes what it
# uses, and the presets "debug" and "sanitize" compile each alone. Of techniques, which change most often, a change compiles a few files more.
# lumivox_precompile(TARGET [HEADERS headers...] [FROM other]): a set of headers of the target's own, or that of another target.
# lumivox_compile_together(TARGET [COUNT]): several sources at a time, by default 8.
# lumivox_compile_quickly(TARGET...): with less optimisation, for what spends its time in other code: texts, graphs of passes, techniques (the device does
# their work), commands, records, pages, plans. It takes a third of the compiler's time away.
# lumivox_compile_quickest(TARGET...): with the least that still reads precompiled headers, for commands, records and pages. On the largest
# files of these it takes 10 to 21 % of the time of -O1 away; -O0 would take as long as -O1, since it cannot read those headers. Its
# warnings of what may be uninitialized are about the standard library's regular expressions.
#   Not for a target whose precompiled headers another reads with more: g++ 12 crashes.
option(LUMIVOX_FAST_BUILD "Read the headers that many sources include once, and compile several sources at a time" ON)

# From precompiled headers g++ 12 forgets which ones are the system's, and then tells of the strings of its own library what it is wrong about
# (its bug 105651). The preset "sanitize" reads every header anew, with these warnings.
if(LUMIVOX_FAST_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
endif()

# Programs are compiled as libraries are, so that both can read the same precompiled headers.
set(CMAKE_CXX_COMPILE_OPTIONS_PIE -fPIC)

set(LUMIVOX_COMMON_HEADERS <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem> <functional> <limits> <map> <memory>
    <mutex> <numbers> <optional> <set> <span> <string> <string_view> <unordered_map> <utility> <vector> <fmt/format.h> <glm/glm.hpp>)

function(lumivox_precompile target)
  cmake_parse_arguments(precompiled "" "FROM" "HEADERS" ${ARGN})
  if(NOT LUMIVOX_FAST_BUILD)
    return()
  endif()
  if(precompiled_FROM)
    target_precompile_headers(${target} REUSE_FROM ${precompiled_FROM})
  else()
    target_precompile_headers(${target} PRIVATE ${precompiled_HEADERS})
  endif()
endfunction()

function(lumivox_compile_together target)
  set(count 8)
  if(ARGC GREATER 1)
    set(count ${ARGV1})
  endif()
  # Types of a source's own seem to be those of a header when several sources are one.
  target_compile_options(${target} PRIVATE $<$<AND:$<BOOL:${LUMIVOX_FAST_BUILD}>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${LUMIVOX_FAST_BUILD} UNITY_BUILD_BATCH_SIZE ${count})
endfunction()

function(lumivox_compile_quickly)
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<BOOL:${LUMIVOX_FAST_BUILD}>:-O1>)
  endforeach()
endfunction()

function(lumivox_compile_quickest)
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<BOOL:${LUMIVOX_FAST_BUILD}>:-Og>
      $<$<AND:$<BOOL:${LUMIVOX_FAST_BUILD}>,$<CXX_COMPILER_ID:GNU>>:-Wno-maybe-uninitialized>)
  endforeach()
endfunction()
