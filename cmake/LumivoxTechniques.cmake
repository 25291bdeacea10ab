# add_shaders(NAME [SOURCE folder] [PACKS folder]): compiles shaders/NAME/*.{vert,geom,frag,comp} (or those of another folder) offline into
# lib/techniques/NAME.shaderpack (or another folder) and generates generated/NAME_shaders.h, the C++ side of their interfaces.
# Target: shaders_NAME. Which files were included is taken from what shaderpack read.
function(add_shaders name)
  cmake_parse_arguments(shaders "" "SOURCE;PACKS" "" ${ARGN})
  if(NOT shaders_SOURCE)
    set(shaders_SOURCE ${CMAKE_SOURCE_DIR}/shaders/${name})
  endif()
  if(NOT shaders_PACKS)
    set(shaders_PACKS ${CMAKE_BINARY_DIR}/lib/techniques)
  endif()
  set(pack ${shaders_PACKS}/${name}.shaderpack)
  set(header ${CMAKE_BINARY_DIR}/generated/${name}_shaders.h)
  file(GLOB entries CONFIGURE_DEPENDS ${shaders_SOURCE}/*.vert ${shaders_SOURCE}/*.geom ${shaders_SOURCE}/*.frag
       ${shaders_SOURCE}/*.comp)
  add_custom_command(
    OUTPUT ${pack} ${header}
    COMMAND shaderpack --technique ${name} --source ${shaders_SOURCE} --include ${CMAKE_SOURCE_DIR}/shaders
            --cache ${CMAKE_BINARY_DIR}/shadercache --pack ${pack} --header ${header} --depfile ${pack}.d
    DEPENDS shaderpack ${entries}
    DEPFILE ${pack}.d
    COMMENT "Compiling shaders of ${name}"
    VERBATIM)
  add_custom_target(shaders_${name} DEPENDS ${pack} ${header})
endfunction()

# add_technique(NAME): the shared library of techniques/NAME/*.cpp, when shaders/NAME exists its shaders, and beside both the paper card
# NAME.md, which explains where the technique breaks.
function(add_technique name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/techniques/${name}/*.cpp)
  add_library(technique_${name} MODULE ${sources})
  set_target_properties(technique_${name} PROPERTIES
    OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/techniques)
  target_link_libraries(technique_${name} PRIVATE lumivox)
  lumivox_precompile(technique_${name} FROM lumivox_base)
  set_property(GLOBAL APPEND PROPERTY LUMIVOX_TECHNIQUES technique_${name})
  set(card ${CMAKE_BINARY_DIR}/lib/techniques/${name}.md)
  add_custom_command(
    OUTPUT ${card}
    COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/techniques/${name}/README.md ${card}
    DEPENDS ${CMAKE_SOURCE_DIR}/techniques/${name}/README.md
    VERBATIM)
  add_custom_target(card_${name} DEPENDS ${card})
  add_dependencies(technique_${name} card_${name})
  if(EXISTS ${CMAKE_SOURCE_DIR}/shaders/${name})
    add_shaders(${name})
    add_dependencies(technique_${name} shaders_${name})
    target_include_directories(technique_${name} PRIVATE ${CMAKE_BINARY_DIR}/generated)
  endif()
endfunction()
