# Everything comes from the distribution's packages (tools/setup installs them); nothing is downloaded here.
# The installed nendoConfig.cmake repeats the library part, because static libraries hand their needs on.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(spdlog REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(libserialport REQUIRED IMPORTED_TARGET libserialport)
pkg_check_modules(libusb REQUIRED IMPORTED_TARGET libusb-1.0)
pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)
if(NENDO_APPS)
  find_package(CLI11 REQUIRED)
  find_package(nlohmann_json 3.11 REQUIRED)
endif()
if(NENDO_TESTS)
  find_package(doctest REQUIRED)
  find_package(nlohmann_json 3.11 REQUIRED)
  find_path(NENDO_OPENXR_INCLUDE openxr/openxr.h REQUIRED) # the header alone: nothing is linked, nothing runs
  pkg_check_modules(umockdev REQUIRED IMPORTED_TARGET umockdev-1.0)
endif()
