include(CMakePackageConfigHelpers)
set(NENDO_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/nendo)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/nendoConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/nendoConfig.cmake INSTALL_DESTINATION ${NENDO_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/nendoConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT nendoTargets NAMESPACE nendo:: DESTINATION ${NENDO_PACKAGE_DIR} COMPONENT development)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/nendoConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/nendoConfigVersion.cmake
  DESTINATION ${NENDO_PACKAGE_DIR} COMPONENT development)

# For what is built without CMake. What a static library needs of others, its user must link; what a shared one does, not.
if(NOT BUILD_SHARED_LIBS)
  set(NENDO_REQUIRES " libserialport libudev libusb-1.0 spdlog libhwy tomlplusplus yaml-0.1 expat")
endif()
file(RELATIVE_PATH NENDO_PC_TO_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${CMAKE_CURRENT_LIST_DIR}/nendo.pc.in ${CMAKE_CURRENT_BINARY_DIR}/nendo.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/nendo.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

if(NENDO_PACKAGES)
  include(NendoPackages)
endif()
