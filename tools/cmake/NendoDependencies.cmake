# Everything comes from the distribution's packages (tools/setup installs them); nothing is downloaded here.
# The installed nendoConfig.cmake repeats the library part, because static libraries hand their needs on.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(spdlog REQUIRED)
find_package(hwy 1.0.3 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(libserialport REQUIRED IMPORTED_TARGET libserialport)
pkg_check_modules(libudev REQUIRED IMPORTED_TARGET libudev)
pkg_check_modules(libusb REQUIRED IMPORTED_TARGET libusb-1.0)
pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_check_modules(libyaml REQUIRED IMPORTED_TARGET yaml-0.1)
pkg_check_modules(expat REQUIRED IMPORTED_TARGET expat)
pkg_check_modules(liblo REQUIRED IMPORTED_TARGET liblo)
find_package(nlohmann_json 3.11 REQUIRED) # headers alone: programs that use the libraries do without
if(NENDO_APPS)
  find_package(CLI11 REQUIRED)
  find_package(PNG REQUIRED)
  pkg_check_modules(libturbojpeg REQUIRED IMPORTED_TARGET libturbojpeg)
  find_path(NENDO_STB_INCLUDE stb/stb_image.h REQUIRED) # headers alone
  find_package(glfw3 3.3 QUIET)
  find_package(OpenGL QUIET COMPONENTS OpenGL OPTIONAL_COMPONENTS GLX)
  pkg_check_modules(imgui IMPORTED_TARGET QUIET imgui)
  set(has_window OFF)
  if(glfw3_FOUND AND TARGET OpenGL::GL AND imgui_FOUND)
    set(has_window ON)
  endif()
  option(NENDO_WINDOW "Build the live window (GLFW, OpenGL, Dear ImGui)" ${has_window})
endif()
if(NENDO_PYTHON)
  if(EXISTS /usr/bin/python3 AND NOT DEFINED Python_EXECUTABLE AND NOT SKBUILD)
    set(Python_EXECUTABLE /usr/bin/python3) # for which Debian's NumPy is
  endif()
  find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module) # before pybind11, which then uses it
  find_package(pybind11 2.10 REQUIRED CONFIG)
endif()
if(NENDO_TESTS)
  find_package(doctest REQUIRED)
  find_path(NENDO_OPENXR_INCLUDE openxr/openxr.h REQUIRED) # the header alone: nothing is linked, nothing runs
  if(NOT CMAKE_CROSSCOMPILING) # it is loaded before a program's own libraries, also in the emulator that would run it
    pkg_check_modules(umockdev REQUIRED IMPORTED_TARGET umockdev-1.0)
  endif()
endif()
