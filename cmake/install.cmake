# Installed files, each in the component that a package takes it from (cmake/packages.cmake).
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dartcast)
foreach(library IN LISTS DARTCAST_LIBRARIES)
  set(component libraries)
  if(library STREQUAL "core")
    set(component core)
  endif()
  install(TARGETS dartcast_${library} EXPORT dartcastTargets
          LIBRARY COMPONENT ${component} NAMELINK_COMPONENT dev
          ARCHIVE COMPONENT dev
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
endforeach()
install(TARGETS dartcast EXPORT dartcastTargets)
install(EXPORT dartcastTargets NAMESPACE dartcast:: DESTINATION ${package_dir} COMPONENT dev)
configure_package_config_file(cmake/dartcastConfig.cmake.in dartcastConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(dartcastConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dartcastConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/dartcastConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT dev)

# For programs that are built without CMake: pkg-config --cflags --libs dartcast.
# Paths are relative to the file, wherever cmake --install --prefix puts it.
file(RELATIVE_PATH pkgconfig_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
set(all_libraries ${DARTCAST_LIBRARIES})
list(REMOVE_ITEM all_libraries mpi)
list(TRANSFORM all_libraries PREPEND -ldartcast_)
list(JOIN all_libraries " " all_libraries)
foreach(name IN ITEMS dartcast dartcast-core)
  set(pkgconfig_name ${name})
  set(pkgconfig_libraries "${all_libraries}")
  if(name STREQUAL "dartcast-core")
    set(pkgconfig_libraries -ldartcast_core)
  endif()
  configure_file(cmake/dartcast.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()

if(TARGET dartcast_command)
  install(TARGETS dartcast_command COMPONENT command)
  if(NOT DARTCAST_PACKAGES)  # Debian wants it compressed
    install(FILES docs/dartcast.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT command)
  endif()
  if(NOT CMAKE_CROSSCOMPILING)
    set(zsh_folder site-functions)
    if(DARTCAST_PACKAGES)  # Debian's zsh looks there
      set(zsh_folder vendor-completions)
    endif()
    set(completion ${PROJECT_BINARY_DIR}/completion)
    install(FILES ${completion}/dartcast DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT command)
    install(FILES ${completion}/_dartcast DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${zsh_folder} COMPONENT command)
  endif()
  set(engine ${PROJECT_SOURCE_DIR}/build/wasm/package)  # of ./dev wasm: what a page runs
  if(EXISTS ${engine}/dartcast.wasm)
    install(FILES ${engine}/dartcast.mjs ${engine}/dartcast.wasm DESTINATION ${CMAKE_INSTALL_DATADIR}/dartcast COMPONENT command)
  endif()
  install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT command)
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command)
