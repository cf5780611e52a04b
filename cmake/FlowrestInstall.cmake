# What is installed, and where. The program finds its parts beside its own folder (scenes/installation.h), so these places are
# fixed under the prefix, and a build tree has the same ones: bin/flowrest, lib/flowrest/openfoam, share/flowrest.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
# So deep that CPack takes the plug-in for no library of the system's, which would want ldconfig run.
set(FLOWREST_OPENFOAM_LIBRARIES lib/flowrest/openfoam)
# Libraries that are not the system's, a VTK of a module's, say, are found by an installed program too.
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)

# flowrest_share(NAME FOLDER [arguments of install(DIRECTORY)]): what the program finds as share/flowrest/NAME.
function(flowrest_share name folder)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/flowrest)
  file(CREATE_LINK ${folder} ${CMAKE_BINARY_DIR}/share/flowrest/${name} SYMBOLIC)
  install(DIRECTORY ${folder}/ DESTINATION share/flowrest/${name} ${ARGN})
endfunction()

install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION share/doc/flowrest)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/flowrest RENAME copyright)
# Pages lead to each other, from the README on.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION share/doc/flowrest)
