# add_shaders(NAME): compiles shaders/NAME/*.{vert,geom,frag,comp} offline into lib/techniques/NAME.shaderpack and generates
# <NAME>_shaders.h, the C++ side of their interfaces. Target: shaders_NAME.
function(add_shaders name)
  set(pack ${CMAKE_BINARY_DIR}/lib/techniques/${name}.shaderpack)
  set(header ${CMAKE_BINARY_DIR}/generated/${name}_shaders.h)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/${name}/* ${CMAKE_SOURCE_DIR}/shaders/common/*)
  add_custom_command(
    OUTPUT ${pack} ${header}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/lib/techniques ${CMAKE_BINARY_DIR}/generated
    COMMAND shaderpack --technique ${name} --source ${CMAKE_SOURCE_DIR}/shaders/${name} --include ${CMAKE_SOURCE_DIR}/shaders
            --cache ${CMAKE_BINARY_DIR}/shadercache --pack ${pack} --header ${header}
    DEPENDS shaderpack ${sources}
    COMMENT "Compiling shaders of ${name}"
    VERBATIM)
  add_custom_target(shaders_${name} DEPENDS ${pack} ${header})
endfunction()

# add_technique(NAME): the shared library of techniques/NAME/*.cpp and, when shaders/NAME exists, its shaders.
function(add_technique name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/techniques/${name}/*.cpp)
  add_library(technique_${name} MODULE ${sources})
  set_target_properties(technique_${name} PROPERTIES
    OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/techniques)
  target_link_libraries(technique_${name} PRIVATE lumivox)
  if(EXISTS ${CMAKE_SOURCE_DIR}/shaders/${name})
    add_shaders(${name})
    add_dependencies(technique_${name} shaders_${name})
    target_include_directories(technique_${name} PRIVATE ${CMAKE_BINARY_DIR}/generated)
  endif()
endfunction()
