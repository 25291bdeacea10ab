# lumivox_part(HOUSE/NAME [NEEDS parts...] [LIBRARIES libraries...])
# One part of a house, the framework or the laboratory: HOUSE/include/lumivox/NAME/*.h and HOUSE/src/NAME/*.cpp, compiled to an object library.
# It sees the packages and the public headers of the parts that it needs, and with them those of their house: the framework has none of the
# laboratory's on its path. A test holds which part may include which.
function(lumivox_part place)
  cmake_parse_arguments(part "" "" "NEEDS;LIBRARIES" ${ARGN})
  get_filename_component(house ${place} DIRECTORY)
  get_filename_component(name ${place} NAME)
  set(folder ${CMAKE_SOURCE_DIR}/${house})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/src/${name}/*.cpp ${folder}/src/${name}/*.h ${folder}/include/lumivox/${name}/*.h)
  add_library(lumivox_${name} OBJECT ${sources})
  set_target_properties(lumivox_${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_include_directories(lumivox_${name} PUBLIC ${folder}/include)
  # What the laboratory needs of the framework's inside is listed in the same test.
  target_include_directories(lumivox_${name} PRIVATE ${folder}/src ${CMAKE_SOURCE_DIR}/framework/src)
  target_link_libraries(lumivox_${name} PUBLIC ${part_LIBRARIES})
  foreach(need IN LISTS part_NEEDS)
    target_link_libraries(lumivox_${name} PUBLIC lumivox_${need}_interface)
  endforeach()
  lumivox_compile_together(lumivox_${name})
  # The first part is the one that all others need.
  if(part_NEEDS)
    lumivox_precompile(lumivox_${name} FROM lumivox_base)
  else()
    lumivox_precompile(lumivox_${name} HEADERS ${LUMIVOX_COMMON_HEADERS})
  endif()
  add_library(lumivox_${name}_interface INTERFACE)
  target_include_directories(lumivox_${name}_interface INTERFACE ${folder}/include)
  target_link_libraries(lumivox_${name}_interface INTERFACE ${part_LIBRARIES})
  foreach(need IN LISTS part_NEEDS)
    target_link_libraries(lumivox_${name}_interface INTERFACE lumivox_${need}_interface)
  endforeach()
endfunction()

# Where headers lie that the build writes.
set(LUMIVOX_GENERATED_INCLUDE ${CMAKE_BINARY_DIR}/generated/include)

# lumivox_headers_hash(PARTS parts...): the hash of the public headers of these parts, as <lumivox/plugin/headers_hash.h>. By it the loader
# tells techniques that were compiled with other headers.
function(lumivox_headers_hash)
  cmake_parse_arguments(hash "" "" "PARTS" ${ARGN})
  set(headers)
  foreach(part IN LISTS hash_PARTS)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/framework/include/lumivox/${part}/*.h)
    list(APPEND headers ${found})
  endforeach()
  string(REPLACE ";" "," parts "${hash_PARTS}")
  set(output ${LUMIVOX_GENERATED_INCLUDE}/lumivox/plugin/headers_hash.h)
  set(stamp ${CMAKE_BINARY_DIR}/generated/headers_hash.stamp)
  add_custom_command(
    OUTPUT ${stamp}
    BYPRODUCTS ${output}
    COMMAND ${CMAKE_COMMAND} -DINCLUDE=${CMAKE_SOURCE_DIR}/framework/include -DPARTS=${parts} -DOUTPUT=${output}
            -P ${CMAKE_SOURCE_DIR}/cmake/LumivoxHeadersHash.cmake
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${headers} ${CMAKE_SOURCE_DIR}/cmake/LumivoxHeadersHash.cmake
    COMMENT "Hashing the public headers"
    VERBATIM)
  add_custom_target(lumivox_headers_hash DEPENDS ${stamp})
endfunction()

# lumivox_library(NAME PARTS parts... [LIBRARIES libraries...] [INSTALLED packages...]): one shared library made of parts. Who builds against the
# installed one needs only the packages that the public headers include. Lumivox::NAME is its name inside the tree and outside.
function(lumivox_library name)
  cmake_parse_arguments(library "" "" "PARTS;LIBRARIES;INSTALLED" ${ARGN})
  set(objects)
  foreach(part IN LISTS library_PARTS)
    list(APPEND objects $<TARGET_OBJECTS:lumivox_${part}>)
  endforeach()
  add_library(${name} SHARED ${objects})
  add_library(Lumivox::${name} ALIAS ${name})
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  foreach(part IN LISTS library_PARTS)
    target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:lumivox_${part}_interface>)
  endforeach()
  target_link_libraries(${name} PUBLIC ${library_LIBRARIES})
  foreach(package IN LISTS library_INSTALLED)
    target_link_libraries(${name} INTERFACE $<INSTALL_INTERFACE:${package}>)
  endforeach()
endfunction()

# lumivox_embed(HOUSE/PART): the files of HOUSE/src/PART/assets become constants of generated/PART_assets.h, so that an editor understands
# them and the program needs none of them beside it.
function(lumivox_embed place)
  get_filename_component(house ${place} DIRECTORY)
  get_filename_component(part ${place} NAME)
  file(GLOB assets CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${house}/src/${part}/assets/*)
  set(header ${CMAKE_BINARY_DIR}/generated/${part}_assets.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} "-DFILES=${assets}" -DOUTPUT=${header} -DNAMESPACE=lumivox::${part}::assets -P ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${assets} ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
    COMMENT "Embedding the assets of ${part}"
    VERBATIM)
  add_custom_target(assets_${part} DEPENDS ${header})
  add_dependencies(lumivox_${part} assets_${part})
  target_include_directories(lumivox_${part} PRIVATE ${CMAKE_BINARY_DIR}/generated)
endfunction()
