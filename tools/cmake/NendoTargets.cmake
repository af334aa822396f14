# nendo_library(<name> SOURCES ... [OPTIMISED ...] HEADERS ... [LIBRARIES ...]) makes nendo_<name> with the alias nendo::<name>,
# its public headers as a verified file set under include/, and everything in src/ private. OPTIMISED names the sources that
# compute in every tick, or for long. With INTERNAL it is static and not installed.
# nendo_settings() is what every target gets.

set(NENDO_SANITIZE "" CACHE STRING "Sanitizers to build with, as -fsanitize takes them")

include(CheckPIESupported)
check_pie_supported() # or CMake would not link a target that asks for it as such

# What Debian's own packages are built with. An overrun buffer ends the program instead of running somebody's code, and
# neither the program's place nor its tables of addresses can be counted on.
function(nendo_harden target)
  if(NOT NENDO_HARDEN OR NENDO_SANITIZE)
    return()
  endif()
  get_target_property(type ${target} TYPE)
  set(release $<CONFIG:Release,RelWithDebInfo>)
  target_compile_options(${target} PRIVATE $<${release}:-fstack-protector-strong -fstack-clash-protection
    -Wp,-U_FORTIFY_SOURCE,-D_FORTIFY_SOURCE=2>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(${target} PRIVATE $<${release}:-fcf-protection>)
  endif()
  if(type MATCHES "EXECUTABLE|SHARED|MODULE")
    target_link_options(${target} PRIVATE $<${release}:LINKER:-z,relro,-z,now,-z,noexecstack>)
  endif()
  if(NOT type STREQUAL "EXECUTABLE" AND BUILD_SHARED_LIBS) # a library's own calls stay in it, and can be inlined
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  endif()
endfunction()

function(nendo_settings target scope)
  target_compile_features(${target} ${scope} cxx_std_20)
  if(scope STREQUAL "INTERFACE")
    return()
  endif()
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  # Every target, because some libraries ask for it, and a precompiled header serves only those that are compiled alike.
  target_compile_options(${target} PRIVATE -pthread)
  nendo_harden(${target})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion
    -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion -Wformat=2
    $<$<BOOL:${NENDO_WERROR}>:-Werror>)
  if(NOT CMAKE_UNITY_BUILD) # there, another file's names are seen, too
    target_compile_options(${target} PRIVATE -Wshadow)
  elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU") # which takes the sources that a batch includes for headers
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Under two gigabytes it leaves its garbage: a tenth of the time that Eigen's templates take, for a sixth more memory.
    # Not where clang-tidy and clangd read the flags, which do not know it.
    target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:SHELL:--param ggc-min-heapsize=2097152>")
  endif()
  # GCC 12 sees impossible lengths in std::string and std::vector that it has inlined, and the insides of empty optionals.
  # Of a precompiled standard library each GCC does, because it takes that for the project's own code.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND (NENDO_PCH OR CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13))
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Wno-restrict -Wno-array-bounds -Wno-stringop-overread
      -Wno-stringop-overflow -Wno-maybe-uninitialized>)
  endif()
  if(NENDO_SANITIZE)
    # Bad pointers are the address sanitizer's to find; the other's checks of them would double the time that Eigen's
    # templates take to compile.
    target_compile_options(${target} PRIVATE -fsanitize=${NENDO_SANITIZE}
      -fno-sanitize=null,alignment,object-size,pointer-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${NENDO_SANITIZE})
  endif()
endfunction()

# nendo_kind(<target> <kind>): the differences between `plain` and `optimised` sources, a `test` and an `optimised_test`.
# Plain sources are compiled with -O1, which takes two thirds of the time of -O3. The level of GCC's precompiled header counts,
# and not that of the source: each kind has a header of its own.
# Where NENDO_PCH is on, the headers that most files see are read once for all targets of a kind. The preset dev has it off,
# and clang-tidy and clangd read that preset's flags: they show whether each file includes what it uses.
function(nendo_kind target kind)
  nendo_kind_options(${target} ${kind})
  if(NENDO_PCH)
    target_precompile_headers(${target} REUSE_FROM nendo_headers_${kind})
    # clang-tidy looks for the headers of the precompiled one, whether or not the target uses Eigen.
    target_include_directories(${target} SYSTEM PRIVATE $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
  endif()
endfunction()

function(nendo_kind_options target kind)
  if(NOT kind MATCHES "test")
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  if(kind STREQUAL "test")
    target_compile_options(${target} PRIVATE -O0)
  elseif(kind MATCHES "plain|optimised_test")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# nendo_precompiled_headers(<kind> [HEADERS ...] [LIBRARIES ...]): makes the headers that nendo_kind() lets targets use.
function(nendo_precompiled_headers kind)
  if(NOT NENDO_PCH)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBRARIES" ${ARGN})
  set(target nendo_headers_${kind})
  set(empty ${PROJECT_BINARY_DIR}/${target}.cpp) # CMake precompiles headers for a target that has a file to compile
  file(CONFIGURE OUTPUT ${empty} CONTENT "")
  add_library(${target} OBJECT ${empty})
  nendo_settings(${target} PRIVATE)
  nendo_kind_options(${target} ${kind})
  target_link_libraries(${target} PRIVATE Eigen3::Eigen ${ARG_LIBRARIES})
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <atomic> <charconv> <chrono> <cstdint> <filesystem> <fstream>
    <functional> <iostream> <map> <memory> <mutex> <optional> <random> <span> <sstream> <string> <thread> <variant> <vector>
    <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> ${ARG_HEADERS})
endfunction()

function(nendo_library name)
  cmake_parse_arguments(ARG "INTERNAL" "" "SOURCES;OPTIMISED;HEADERS;LIBRARIES" ${ARGN})
  set(target nendo_${name})
  set(scope PUBLIC)
  set(kind "")
  if(ARG_INTERNAL)
    set(kind STATIC)
  endif()
  if(ARG_SOURCES OR ARG_OPTIMISED)
    add_library(${target} ${kind} ${ARG_SOURCES})
    nendo_settings(${target} PUBLIC)
    nendo_kind(${target} plain)
    target_include_directories(${target} PRIVATE src)
    if(ARG_OPTIMISED)
      add_library(${target}_optimised OBJECT ${ARG_OPTIMISED})
      nendo_settings(${target}_optimised PRIVATE)
      nendo_kind(${target}_optimised optimised)
      target_include_directories(${target}_optimised PRIVATE src include)
      target_link_libraries(${target}_optimised ${ARG_LIBRARIES})
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_optimised>)
    endif()
    set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION}
      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  else()
    add_library(${target} INTERFACE)
    nendo_settings(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  if(ARG_LIBRARIES)
    target_link_libraries(${target} ${ARG_LIBRARIES})
  endif()
  add_library(nendo::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS include FILES ${ARG_HEADERS})
  if(ARG_INTERNAL)
    return()
  endif()
  install(TARGETS ${target} EXPORT nendoTargets FILE_SET HEADERS COMPONENT development
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
endfunction()

# nendo_module(<name> [OPTIMISED] SOURCES ... LIBRARIES ...): makes a module of the program, nendo::<name>, which is not
# installed. Its headers are included with quotes, by paths that begin with the module's folder.
function(nendo_module name)
  cmake_parse_arguments(ARG "OPTIMISED" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target nendo_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(nendo::${name} ALIAS ${target})
  nendo_settings(${target} PRIVATE)
  if(ARG_OPTIMISED)
    nendo_kind(${target} optimised)
  else()
    nendo_kind(${target} plain)
  endif()
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/apps)
  if(ARG_LIBRARIES)
    target_link_libraries(${target} ${ARG_LIBRARIES})
  endif()
endfunction()

# nendo_separate_program(NAME COMPONENT LIBRARY): a program with a package of its own. main.cpp is all but the library, which
# tests also link, and NAME.1 is its manual page.
function(nendo_separate_program name component library)
  add_executable(${name} main.cpp)
  nendo_settings(${name} PRIVATE)
  target_link_libraries(${name} PRIVATE ${library})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})

  set(page ${CMAKE_CURRENT_BINARY_DIR}/${name}.1.gz)
  add_custom_command(OUTPUT ${page}
    COMMAND sh -c "exec gzip -9nc '${CMAKE_CURRENT_SOURCE_DIR}/${name}.1' > '${page}'" # as Debian has them
    DEPENDS ${name}.1
    VERBATIM)
  add_custom_target(${component}_manual ALL DEPENDS ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
endfunction()
