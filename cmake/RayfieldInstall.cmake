include(CMakePackageConfigHelpers)
install(EXPORT rayfieldTargets NAMESPACE rayfield:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rayfield)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/rayfieldConfig.cmake.in
  ${PROJECT_BINARY_DIR}/rayfieldConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rayfield)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rayfieldConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rayfieldConfig.cmake ${PROJECT_BINARY_DIR}/rayfieldConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rayfield)

# Beside the program: its pages, and sites to simulate. The libraries and their headers are in no component.
if("cli" IN_LIST RAYFIELD_ROOMS)
  install(FILES LICENSE README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(DIRECTORY sim/sites/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program
    FILES_MATCHING PATTERN "*.toml")
  include(RayfieldPackage)
endif()
