# cmake --install, find_package(Pagoda) and the Debian package. Every library that pagoda_library()
# made below ooc/, cache/, hlod/, vdr/ and viewer/ is exported as Pagoda::NAME; viewer/ is a component of its
# own, so that a program that only reads needs no GL.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Pagoda)
get_property(libraries GLOBAL PROPERTY PAGODA_LIBRARIES)
foreach(name IN LISTS libraries)
  get_target_property(folder pagoda_${name} SOURCE_DIR)
  cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
  if(folder MATCHES "^(tools|viewer/window)")  # the program's own
    continue()
  elseif(folder MATCHES "^viewer")
    set(export PagodaViewerTargets)
  else()
    set(export PagodaTargets)
  endif()
  set_target_properties(pagoda_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS pagoda_${name} EXPORT ${export} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  list(APPEND exports ${export})
endforeach()
list(REMOVE_DUPLICATES exports)
foreach(export IN LISTS exports)
  install(EXPORT ${export} NAMESPACE Pagoda:: DESTINATION ${package_dir})
endforeach()

set(header_folders ooc cache hlod)
if(EXISTS ${PROJECT_SOURCE_DIR}/vdr/CMakeLists.txt)
  list(APPEND header_folders vdr)
endif()
if(PAGODA_VIEWER)
  list(APPEND header_folders viewer)
endif()
# Headers include each other from the repository root, so that root is include/pagoda.
install(DIRECTORY ${header_folders} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pagoda
  FILES_MATCHING PATTERN "*.h" PATTERN "*.inl" PATTERN "viewer/window" EXCLUDE)

configure_package_config_file(cmake/PagodaConfig.cmake.in PagodaConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(PagodaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/PagodaConfig.cmake
  ${PROJECT_BINARY_DIR}/PagodaConfigVersion.cmake DESTINATION ${package_dir})
install(FILES packaging/copyright README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pagoda)

# cpack -G DEB: the libraries it needs are found by dpkg-shlibdeps (package dpkg-dev).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pagoda)
set(CPACK_PACKAGE_CONTACT "Pagoda developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "out-of-core viewer for massive models")
set(CPACK_PACKAGE_DESCRIPTION
  "Builds a paged database from meshes of any size, looks into it, proves it sound and draws pictures.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(PAGODA_VIEWER)
  # Loaded by libEGL at run time, so no linker knows of it.
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri)
  # The window's font; it has another without.
  list(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS fonts-dejavu-core)
  # A program that `pagoda bench --html` calls for its figures.
  list(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
  list(JOIN CPACK_DEBIAN_PACKAGE_RECOMMENDS ", " CPACK_DEBIAN_PACKAGE_RECOMMENDS)
endif()
include(CPack)
