# `cpack -G DEB` in a build folder makes a Debian package of the program alone, for users: nothing to develop with.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rayfield)
set(CPACK_PACKAGE_VENDOR "The rayfield authors")
set(CPACK_PACKAGE_CONTACT "The rayfield authors <maintainers@rayfield.invalid>" CACHE STRING
  "Maintainer of the Debian package: who distributes it")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "lidar drives through vineyards to canopy density maps")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Registers logs of a spinning lidar on a farm vehicle, keeps their rays in a
store with all dates of a block, and maps one-sided leaf area per cubic metre,
panel, half metre of row and as a plan raster, with intervals, as GeoTIFF,
GeoPackage, pictures and a report for the grower.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program debian)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What the program opens by name: the tables of coordinate systems and formats come with their libraries; pictures want a
# font.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

# What Debian wants beside the program's own pages.
execute_process(COMMAND date -u -R -d "${RAYFIELD_DATE}" OUTPUT_VARIABLE package_date OUTPUT_STRIP_TRAILING_WHITESPACE)
configure_file(${PROJECT_SOURCE_DIR}/cmake/debian/changelog.in ${PROJECT_BINARY_DIR}/changelog.Debian @ONLY)
execute_process(COMMAND gzip -9nkf ${PROJECT_BINARY_DIR}/changelog.Debian)
install(FILES ${PROJECT_BINARY_DIR}/changelog.Debian.gz ${PROJECT_SOURCE_DIR}/cmake/debian/copyright
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT debian EXCLUDE_FROM_ALL)
include(CPack)
