# How a technique is built, inside the tree and outside of it (find_package(Lumivox)): the same functions in both. A project with techniques
# has the folders techniques/NAME, shaders/NAME, scenes/pipelines and tests/techniques, as `lumivox new technique NAME` writes them.

# lumivox_add_shaders(NAME [SOURCE folder] [PACKS folder]): compiles *.{vert,geom,frag,comp} of shaders/NAME (or of another folder) and of the
# folders below offline into lib/techniques/NAME.shaderpack (or another folder) and generates generated/NAME_shaders.h, the C++ side of their
# interfaces. Target: shaders_NAME. Which files were included is taken from what shaderpack read.
function(lumivox_add_shaders name)
  cmake_parse_arguments(shaders "" "SOURCE;PACKS" "" ${ARGN})
  if(NOT shaders_SOURCE)
    set(shaders_SOURCE ${PROJECT_SOURCE_DIR}/shaders/${name})
  endif()
  if(NOT shaders_PACKS)
    set(shaders_PACKS ${PROJECT_BINARY_DIR}/lib/techniques)
  endif()
  # The project's own shaders first; then those that come with Lumivox, which lie beside this file's folder in the tree and installed.
  cmake_path(SET common NORMALIZE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../shaders)
  set(roots ${PROJECT_SOURCE_DIR}/shaders ${common})
  list(REMOVE_DUPLICATES roots)
  set(pack ${shaders_PACKS}/${name}.shaderpack)
  set(header ${PROJECT_BINARY_DIR}/generated/${name}_shaders.h)
  file(GLOB_RECURSE entries CONFIGURE_DEPENDS ${shaders_SOURCE}/*.vert ${shaders_SOURCE}/*.geom ${shaders_SOURCE}/*.frag
       ${shaders_SOURCE}/*.comp)
  add_custom_command(
    OUTPUT ${pack} ${header}
    COMMAND Lumivox::shaderpack --technique ${name} --source ${shaders_SOURCE} --include ${roots}
            --cache ${PROJECT_BINARY_DIR}/shadercache --pack ${pack} --header ${header} --depfile ${pack}.d
    DEPENDS Lumivox::shaderpack ${entries}
    DEPFILE ${pack}.d
    COMMENT "Compiling shaders of ${name}"
    VERBATIM)
  add_custom_target(shaders_${name} DEPENDS ${pack} ${header})
endfunction()

# lumivox_add_technique(NAME [LIBRARIES libraries...]): the shared library of *.cpp in techniques/NAME and the folders below, when shaders/NAME
# exists its shaders, and beside both the paper card NAME.md, which explains where the technique breaks; installed where the program seeks
# techniques. A technique in chapters has a card in each folder: NAME.md is all of them, one behind the other. Target: technique_NAME.
function(lumivox_add_technique name)
  cmake_parse_arguments(technique "" "" "LIBRARIES" ${ARGN})
  set(folder ${PROJECT_SOURCE_DIR}/techniques/${name})
  set(built ${PROJECT_BINARY_DIR}/lib/techniques)
  set(installed lib/lumivox/techniques)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  if(NOT sources)
    message(FATAL_ERROR "lumivox_add_technique(${name}): there is no source ${folder}/*.cpp")
  endif()
  if(NOT EXISTS ${folder}/README.md)
    message(FATAL_ERROR "lumivox_add_technique(${name}): the paper card ${folder}/README.md is missing; expected the paper, "
      "what is implemented, deviations, claims and limits; 'lumivox new technique' writes one to start from")
  endif()
  add_library(technique_${name} MODULE ${sources})
  set_target_properties(technique_${name} PROPERTIES
    OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${built} INSTALL_RPATH $ORIGIN/.. CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  # Only its entry point is seen from outside. The compiler cannot hide templates of the standard library, so the linker does.
  set(symbols ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/LumivoxTechnique.map)
  target_link_options(technique_${name} PRIVATE LINKER:--version-script=${symbols})
  set_property(TARGET technique_${name} APPEND PROPERTY LINK_DEPENDS ${symbols})
  target_link_libraries(technique_${name} PRIVATE Lumivox::lumivox ${technique_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY LUMIVOX_TECHNIQUES technique_${name})
  set(card ${built}/${name}.md)
  file(GLOB chapters CONFIGURE_DEPENDS ${folder}/*/README.md)
  add_custom_command(
    OUTPUT ${card}
    COMMAND ${CMAKE_COMMAND} -E cat ${folder}/README.md ${chapters} > ${card}
    DEPENDS ${folder}/README.md ${chapters}
    VERBATIM)
  add_custom_target(card_${name} DEPENDS ${card})
  add_dependencies(technique_${name} card_${name})
  install(TARGETS technique_${name} LIBRARY DESTINATION ${installed})
  install(FILES ${card} DESTINATION ${installed})
  if(EXISTS ${PROJECT_SOURCE_DIR}/shaders/${name})
    lumivox_add_shaders(${name})
    add_dependencies(technique_${name} shaders_${name})
    target_include_directories(technique_${name} PRIVATE ${PROJECT_BINARY_DIR}/generated)
    install(FILES ${built}/${name}.shaderpack DESTINATION ${installed})
  endif()
endfunction()

# lumivox_add_technique_test(NAME): the program NAME_test of tests/techniques/NAME_test.cpp (Catch2), which finds the project's techniques and
# runs in the project's folder; ctest runs each of its test cases. Outside of the tree alone, whose own tests share a library.
function(lumivox_add_technique_test name)
  find_package(Catch2 2 REQUIRED)
  include(${Catch2_DIR}/Catch.cmake)  # its config tells where only the first time
  add_executable(${name}_test ${PROJECT_SOURCE_DIR}/tests/techniques/${name}_test.cpp)
  set_target_properties(${name}_test PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin CXX_EXTENSIONS OFF)
  target_link_libraries(${name}_test PRIVATE Lumivox::lumivox Catch2::Catch2WithMain)
  add_dependencies(${name}_test technique_${name})
  catch_discover_tests(${name}_test TEST_PREFIX "${name}: " WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} DISCOVERY_MODE PRE_TEST
    PROPERTIES ENVIRONMENT LUMIVOX_TECHNIQUES=${PROJECT_BINARY_DIR}/lib/techniques)
endfunction()
