# cmake -DINCLUDE=<folder> -DPARTS=<parts> -DOUTPUT=<file> -P LumivoxHeadersHash.cmake
# Writes a header with a hash of the public headers of these parts; comments, blanks and line ends do not count. The file is touched only when
# the hash is another, so that nothing is compiled again for a comment.
string(REPLACE "," ";" parts "${PARTS}")
set(all "")
foreach(part IN LISTS parts)
  file(GLOB_RECURSE headers RELATIVE ${INCLUDE} ${INCLUDE}/lumivox/${part}/*.h)
  list(SORT headers)
  foreach(header IN LISTS headers)
    file(READ ${INCLUDE}/${header} text)
    string(REGEX REPLACE "//[^\n]*" "" text "${text}")
    string(REGEX REPLACE "[ \t\r\n]+" " " text "${text}")
    string(SHA1 hash "${text}")
    string(APPEND all "${header} ${hash}\n")
  endforeach()
endforeach()
string(SHA1 hash "${all}")
string(SUBSTRING ${hash} 0 16 hash)
set(content "// Written by the build (cmake/LumivoxHeadersHash.cmake).
#pragma once

namespace lumivox {

/// Of the public headers that a technique may include.
inline constexpr const char* kHeadersHash = \"${hash}\";

}  // namespace lumivox
")
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT old STREQUAL content)
  file(WRITE ${OUTPUT} "${content}")
endif()
