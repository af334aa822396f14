include(CMakePackageConfigHelpers)
set(NENDO_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/nendo)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/nendoConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/nendoConfig.cmake INSTALL_DESTINATION ${NENDO_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/nendoConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT nendoTargets NAMESPACE nendo:: DESTINATION ${NENDO_PACKAGE_DIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/nendoConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/nendoConfigVersion.cmake
  DESTINATION ${NENDO_PACKAGE_DIR})
