include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dartcast)
list(TRANSFORM DARTCAST_LIBRARIES PREPEND dartcast_ OUTPUT_VARIABLE targets)
install(TARGETS dartcast ${targets} EXPORT dartcastTargets FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT dartcastTargets NAMESPACE dartcast:: DESTINATION ${package_dir})
if(TARGET dartcast_command)
  install(TARGETS dartcast_command)
endif()
configure_package_config_file(cmake/dartcastConfig.cmake.in dartcastConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(dartcastConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dartcastConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/dartcastConfigVersion.cmake
        DESTINATION ${package_dir})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
