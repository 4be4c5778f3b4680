# Debian packages, by cpack -G DEB in a build that -DDARTCAST_PACKAGES=ON configured: ./dev packages.
if(NOT DARTCAST_PACKAGES)
  return()
endif()

# The files that Debian wants in each package: whose work it is, and what has changed.
find_program(GZIP gzip REQUIRED)
set(papers ${CMAKE_CURRENT_BINARY_DIR}/packages)
file(MAKE_DIRECTORY ${papers})
configure_file(cmake/copyright.in ${papers}/copyright COPYONLY)
set(contact "The authors of dartcast <dartcast@example.org>")
file(WRITE ${papers}/changelog "dartcast (${PROJECT_VERSION}) unstable; urgency=medium

  * See CHANGELOG.md beside the sources.

 -- ${contact}  Sun, 01 Nov 2026 12:00:00 +0000
")
foreach(file IN ITEMS ${papers}/changelog ${PROJECT_SOURCE_DIR}/docs/dartcast.1)
  get_filename_component(name ${file} NAME)
  execute_process(COMMAND ${GZIP} -9nc ${file} OUTPUT_FILE ${papers}/${name}.gz COMMAND_ERROR_IS_FATAL ANY)
endforeach()
install(FILES ${papers}/dartcast.1.gz DESTINATION share/man/man1 COMPONENT command)
file(WRITE ${papers}/triggers "activate-noawait ldconfig\n")

# Adds a package: its component, name, section, what it needs of the others, and what it is.
function(add_package component name section depends summary text)
  string(TOUPPER ${component} upper)
  install(FILES ${papers}/copyright DESTINATION share/doc/${name} COMPONENT ${component})
  install(FILES ${papers}/changelog.gz DESTINATION share/doc/${name} COMPONENT ${component})
  foreach(pair IN ITEMS "PACKAGE_NAME=${name}" "PACKAGE_SECTION=${section}" "PACKAGE_DEPENDS=${depends}" "DESCRIPTION=${summary}\n ${text}")
    string(REGEX MATCH "^([A-Z_]+)=(.*)$" ignored "${pair}")
    set(CPACK_DEBIAN_${upper}_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}" PARENT_SCOPE)
  endforeach()
  set(CPACK_DEBIAN_${upper}_FILE_NAME DEB-DEFAULT PARENT_SCOPE)
  if(component MATCHES "^(core|libraries)$")
    set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${papers}/triggers PARENT_SCOPE)
  endif()
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
endfunction()

set(same "(= ${PROJECT_VERSION})")
set(CPACK_COMPONENTS_ALL)
add_package(core libdartcast-core libs "" "collisions of particles in deforming meshes: the core"
  "The combinatorial map, exact predicates, walks, contacts and edits. It needs\n no format of files.")
add_package(libraries libdartcast libs "libdartcast-core ${same}" "collisions of particles in deforming meshes"
  "Simulations, spheres, bodies, catheters and solids; meshes and scenes from\n files, and the output of runs.")
add_package(dev libdartcast-dev libdevel "libdartcast ${same}, libdartcast-core ${same}"
  "collisions of particles in deforming meshes: headers"
  "Headers, and the files by which CMake and pkg-config find the libraries.")
add_package(command dartcast science "libdartcast ${same}, libdartcast-core ${same}"
  "carries particles through deforming meshes, exactly"
  "Runs scenes, checks and converts meshes, and writes reports for the browser.\n Scenes to try are in /usr/share/doc/dartcast/examples.")
find_package(Python 3.9 REQUIRED COMPONENTS Interpreter)
math(EXPR next "${Python_VERSION_MINOR} + 1")
set(python "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
add_package(python_package python3-dartcast python "libdartcast ${same}, libdartcast-core ${same}, ${python}"
  "collisions of particles in deforming meshes: Python" "The whole library for NumPy.")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dartcast)
set(CPACK_PACKAGE_CONTACT "${contact}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
