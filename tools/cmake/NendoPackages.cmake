# Debian packages, split as Debian does: the program, the libraries (named by their soname, so that two versions can be
# installed beside each other), what one builds programs with, the udev rules, which are no version's and therefore
# a package of their own, nendo-markers, which needs OpenCV, nendo-ros2, which needs DDS, nendo-openxr, which OpenXR's loader finds
# once it is installed, and the module for Python, which needs one version of it.
# tools/package builds and checks them.
set(NENDO_SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(library_package libnendo${NENDO_SOVERSION})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
if(CMAKE_CROSSCOMPILING AND CMAKE_LIBRARY_ARCHITECTURE STREQUAL "aarch64-linux-gnu")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64) # CPack takes this machine's otherwise
endif()
set(CPACK_PACKAGE_CONTACT "Nendo maintainers <maintainers@nendo.example>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program library c development udev)
if(NENDO_MARKERS)
  list(APPEND CPACK_COMPONENTS_ALL markers)
endif()
if(NENDO_ROS2)
  list(APPEND CPACK_COMPONENTS_ALL ros2)
endif()
if(NENDO_OPENXR)
  list(APPEND CPACK_COMPONENTS_ALL openxr)
endif()
if(NENDO_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# The libraries, and where the build has them: dpkg-shlibdeps looks for them there.
set(libraries driver/base udev driver hand deform apps/puppet apps/flow apps/recording apps/sculpting)
list(TRANSFORM libraries PREPEND ${PROJECT_BINARY_DIR}/ OUTPUT_VARIABLE CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS)

# nendo_package(COMPONENT NAME SECTION SUMMARY TEXT): `TEXT` follows the line that all of them share.
function(nendo_package component name section summary text)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${summary}
Nendo turns data gloves into hands that shape 3-D models: drivers for
CyberGloves, LucidGloves, 5DT, Forte and P5 gloves, and a loop at a fixed
rate that deforms a mesh with the fingertips of both hands.
.
${text}" PARENT_SCOPE)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${PROJECT_SOURCE_DIR}/tools/debian/copyright DESTINATION ${doc} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/debian/changelog.gz DESTINATION ${doc} COMPONENT ${component})
endfunction()

nendo_package(program nendo science "data gloves that shape 3-D models"
  "This package has the program.")
nendo_package(library ${library_package} libs "data gloves that shape 3-D models - libraries"
  "This package has the shared libraries.")
nendo_package(c libnendo-c1 libs "data gloves that shape 3-D models - C interface"
  "This package has the shared library for programs in C, Unity or Rust.")
nendo_package(development libnendo-dev libdevel "data gloves that shape 3-D models - for building programs"
  "This package has headers, and files for CMake and pkg-config.")
nendo_package(udev nendo-udev misc "data gloves that shape 3-D models - udev rules"
  "This package has the rules by which udev knows data gloves and SpaceMice, lets
the user at the screen open them, and keeps ModemManager off gloves.")
if(NENDO_MARKERS)
  nendo_package(markers nendo-markers science "data gloves that shape 3-D models - wrists tracked by a camera"
    "This package has nendo-markers, which finds printed bracelets in the pictures
of a camera, and sends where the wrists are to a run of nendo.")
endif()
if(NENDO_ROS2)
  nendo_package(ros2 nendo-ros2 science "data gloves that shape 3-D models - hands for ROS 2"
    "This package has nendo-ros2, which publishes the hands of a run of nendo to
programs of ROS 2, through DDS. ROS need not be installed.")
endif()
if(NENDO_OPENXR)
  nendo_package(openxr nendo-openxr science "data gloves that shape 3-D models - hands for OpenXR's applications"
    "This package has an API layer for OpenXR, by which any application that asks
for XR_EXT_hand_tracking gets the hands of a run of nendo.")
endif()
if(NENDO_PYTHON)
  nendo_package(python python3-nendo python "data gloves that shape 3-D models - Python module"
    "This package has the module nendo, with which Python reads gloves, poses
hands, deforms meshes and replays recordings, as NumPy arrays.")
endif()

set(same "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${library_package} ${same}, nendo-udev (>= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "fonts-inter | fonts-dejavu-core")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS nendo-udev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
  ${PROJECT_BINARY_DIR}/debian/triggers ${PROJECT_BINARY_DIR}/debian/shlibs)
set(CPACK_DEBIAN_C_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_C_PACKAGE_DEPENDS "${library_package} ${same}")
set(CPACK_DEBIAN_C_PACKAGE_RECOMMENDS nendo-udev)
file(WRITE ${PROJECT_BINARY_DIR}/debian/c/shlibs "libnendo_c 1 libnendo-c1 (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_C_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers ${PROJECT_BINARY_DIR}/debian/c/shlibs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library_package} ${same}, libnendo-c1 ${same}, libeigen3-dev")
set(CPACK_DEBIAN_UDEV_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_MARKERS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MARKERS_PACKAGE_DEPENDS "${library_package} ${same}")
set(CPACK_DEBIAN_MARKERS_PACKAGE_RECOMMENDS nendo)
set(CPACK_DEBIAN_ROS2_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ROS2_PACKAGE_DEPENDS "${library_package} ${same}")
set(CPACK_DEBIAN_ROS2_PACKAGE_RECOMMENDS nendo)
set(CPACK_DEBIAN_OPENXR_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_OPENXR_PACKAGE_RECOMMENDS "nendo, libopenxr-loader1")
if(NENDO_PYTHON)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${library_package} ${same}, python3-numpy, \
python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}~), python3 (<< ${Python_VERSION_MAJOR}.${next_minor})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS nendo-udev)
  # As dh_python3 makes them: compiled files come with the package, and go with it.
  set(shell "#!/bin/sh\nset -e\n")
  file(WRITE ${PROJECT_BINARY_DIR}/debian/postinst
    "${shell}if [ \"$1\" = configure ] && command -v py3compile >/dev/null; then\n  py3compile -p python3-nendo\nfi\n")
  file(WRITE ${PROJECT_BINARY_DIR}/debian/prerm
    "${shell}if command -v py3clean >/dev/null; then\n  py3clean -p python3-nendo\nfi\n")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/postinst ${PROJECT_BINARY_DIR}/debian/prerm)
endif()

# Files that debhelper would make.
string(TIMESTAMP when "%a, %d %b %Y %H:%M:%S +0000" UTC) # of SOURCE_DATE_EPOCH, if that is set
cmake_host_system_information(RESULT suite QUERY DISTRIB_VERSION_CODENAME)
file(WRITE ${PROJECT_BINARY_DIR}/debian/changelog "nendo (${PROJECT_VERSION}) ${suite}; urgency=medium

  * CHANGELOG.md says what changed.

 -- ${CPACK_PACKAGE_CONTACT}  ${when}
")
execute_process(COMMAND gzip -9nf ${PROJECT_BINARY_DIR}/debian/changelog COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(shlibs "")
foreach(library ${libraries})
  cmake_path(GET library FILENAME name)
  string(APPEND shlibs "libnendo_${name} ${NENDO_SOVERSION} ${library_package} (>= ${PROJECT_VERSION})\n")
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/debian/shlibs "${shlibs}")

include(CPack)
