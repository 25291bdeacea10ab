# Files that `cmake --install build --prefix P` copies, after `ninja -C build sdk`: programs, libraries, headers, the CMake package, and
# below share/lumivox what they read: shaders that techniques include, scenes, templates, guides. Libraries are found relative to each other, and data
# relative to the program, so that P may lie anywhere and be moved.
include(CMakePackageConfigHelpers)

set(data share/lumivox)
set(package ${data}/cmake)  # one of the places where find_package looks
set_target_properties(lumivox lumivox_lab lumivox_volume PROPERTIES INSTALL_RPATH $ORIGIN)
set_target_properties(lumivox_command vdbexport PROPERTIES INSTALL_RPATH $ORIGIN/../lib/lumivox)
install(TARGETS lumivox lumivox_lab lumivox_command vdbexport shaderpack EXPORT LumivoxTargets
  RUNTIME DESTINATION bin LIBRARY DESTINATION lib/lumivox INCLUDES DESTINATION include)
set_target_properties(lumivox_view PROPERTIES INSTALL_RPATH $ORIGIN/../lib/lumivox)
install(TARGETS lumivox_view RUNTIME DESTINATION bin)
install(TARGETS lumivox_volume LIBRARY DESTINATION lib/lumivox)
foreach(shaders toolkit device)
  install(FILES ${CMAKE_BINARY_DIR}/lib/shaders/${shaders}.shaderpack DESTINATION lib/lumivox/shaders)
endforeach()
install(DIRECTORY framework/include/lumivox laboratory/include/lumivox DESTINATION include FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${LUMIVOX_GENERATED_INCLUDE}/lumivox DESTINATION include)

install(EXPORT LumivoxTargets NAMESPACE Lumivox:: DESTINATION ${package})
configure_package_config_file(cmake/LumivoxConfig.cmake.in ${CMAKE_BINARY_DIR}/generated/cmake/LumivoxConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/generated/cmake/LumivoxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/generated/cmake/LumivoxConfig.cmake ${CMAKE_BINARY_DIR}/generated/cmake/LumivoxConfigVersion.cmake
  cmake/LumivoxTechniques.cmake cmake/LumivoxTechnique.map DESTINATION ${package})

install(DIRECTORY shaders/common shaders/toolkit DESTINATION ${data}/shaders)
install(DIRECTORY scenes templates examples DESTINATION ${data})
# The guides link to each other and to the cards, as they do in the tree.
install(DIRECTORY docs DESTINATION ${data})
install(FILES README.md CONTRIBUTING.md CHANGELOG.md CITATION.cff LICENSE DESTINATION ${data})
install(DIRECTORY techniques DESTINATION ${data} FILES_MATCHING PATTERN "README.md" PATTERN "*.png" PATTERN "*.svg")
# What the map of the house links to, without the empty folders that install(DIRECTORY) would make.
foreach(folder cmake framework laboratory shaders tests tools)
  file(GLOB_RECURSE readmes CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/${folder}/README.md)
  foreach(readme IN LISTS readmes)
    cmake_path(GET readme PARENT_PATH place)
    install(FILES ${readme} DESTINATION ${data}/${place})
  endforeach()
endforeach()
install(FILES LICENSE DESTINATION share/doc/lumivox RENAME copyright)

# Written by the programs that were just installed, from their own descriptions: manual pages, completions, and grammars for editors.
install(CODE [[
  set(prefix $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX})
  function(write_by program file)
    cmake_path(GET file PARENT_PATH folder)
    file(MAKE_DIRECTORY ${prefix}/share/${folder})
    message(STATUS "Installing: ${prefix}/share/${file}")
    execute_process(COMMAND ${prefix}/bin/${program} ${ARGN} OUTPUT_FILE ${prefix}/share/${file} COMMAND_ERROR_IS_FATAL ANY)
  endfunction()
  foreach(program lumivox vdbexport)
    write_by(${program} man/man1/${program}.1 --print-man)
    write_by(${program} bash-completion/completions/${program} --print-completion bash)
    write_by(${program} zsh/site-functions/_${program} --print-completion zsh)
    write_by(${program} fish/vendor_completions.d/${program}.fish --print-completion fish)
  endforeach()
  write_by(lumivox lumivox/editors/lumivox.tmLanguage.json describe --highlighting textmate)
  write_by(lumivox lumivox/editors/vim/syntax/lumivox.vim describe --highlighting vim)
  file(MAKE_DIRECTORY ${prefix}/share/lumivox/editors/vim/ftdetect)
  file(WRITE ${prefix}/share/lumivox/editors/vim/ftdetect/lumivox.vim
    "autocmd BufRead,BufNewFile *.scene,*.pipeline,*.sweep,*.reproduction setfiletype lumivox\n")
]])

# Everything that is installed, and none of the tests: `ninja -C build sdk && cmake --install build`, or `cd build && cpack -G DEB`.
get_property(techniques GLOBAL PROPERTY LUMIVOX_TECHNIQUES)
add_custom_target(sdk DEPENDS lumivox_command lumivox_view vdbexport shaderpack lumivox_volume shaders_toolkit shaders_device ${techniques})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lumivox)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "laboratory for real-time global illumination")
set(CPACK_PACKAGE_DESCRIPTION "Techniques are shared libraries, scenes and pipelines two short texts: renders them, measures their error \
against a path-traced reference and the time of every pass. With headers and a CMake package for techniques of one's own.")
set(CPACK_PACKAGE_CONTACT "The Lumivox project <lumivox@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
# Libraries by what the programs and techniques link; besides them what is opened while they run, and what a technique is built with.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libegl1, libgl1, libopengl0, libgl1-mesa-dri, libjs-chart.js")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "g++, cmake (>= 3.25), ninja-build, libglm-dev, libfmt-dev, nlohmann-json3-dev, catch2 (<< 3)")
set(CPACK_STRIP_FILES ON)
include(CPack)
