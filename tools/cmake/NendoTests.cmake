# nendo_test(<name> SOURCES ... LIBRARIES ... [INCLUDES ...] [PROGRAM] [ALONE] [OPTIMISED] [COMPUTES]): one doctest program
# test_<name>, one ctest case per TEST_CASE. INCLUDES names private src/ folders of the unit under test. PROGRAM: the tests
# run nendo, whose path is NENDO_PROGRAM. ALONE: nothing else is tested meanwhile. OPTIMISED doubles the compile time; it is
# for tests that compute much themselves, or test templates, which are compiled with the test. COMPUTES: these wait for no
# clock and no device, and give way to tests that do.
include(doctest)

# What tools/check builds with the address sanitizer: the tests of libraries and of parsers, and the fuzz
# targets.
add_custom_target(library_tests)
set(library_tests base explorer udev driver emulator hand deform puppet flow recording sculpting c publish web serve markers openxr serialport usb)
add_custom_target(fuzz_targets)

# doctest's own implementation, compiled once for all test programs.
add_library(nendo_test_main OBJECT EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/tests/support/main.cpp)
nendo_settings(nendo_test_main PRIVATE)
target_link_libraries(nendo_test_main PUBLIC doctest::doctest)

# What is tested is optimised as users have it; what tests it need not be.
foreach(kind test optimised_test)
  nendo_precompiled_headers(${kind} HEADERS <doctest/doctest.h> <nlohmann/json.hpp>
    LIBRARIES doctest::doctest nlohmann_json::nlohmann_json)
endforeach()

function(nendo_test name)
  cmake_parse_arguments(ARG "PROGRAM;ALONE;OPTIMISED;COMPUTES" "" "SOURCES;LIBRARIES;INCLUDES" ${ARGN})
  set(target test_${name})
  add_executable(${target} ${ARG_SOURCES})
  # These replace malloc and the like, or stand before a program's own libraries: each is compiled alone.
  foreach(source ${ARG_SOURCES})
    if(source MATCHES "tests/support/")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  nendo_settings(${target} PRIVATE)
  if(ARG_OPTIMISED)
    nendo_kind(${target} optimised_test)
  else()
    nendo_kind(${target} test)
  endif()
  target_link_libraries(${target} PRIVATE nendo_test_main ${ARG_LIBRARIES})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests ${ARG_INCLUDES})
  if(name IN_LIST library_tests)
    add_dependencies(library_tests ${target})
  endif()
  if(ARG_PROGRAM)
    target_compile_definitions(${target} PRIVATE NENDO_PROGRAM="$<TARGET_FILE:nendo>")
    add_dependencies(${target} nendo)
    if(TARGET nendo-bench) # nendo bench starts it
      add_dependencies(${target} nendo-bench)
    endif()
  endif()
  set(timeout_s 300) # a tenth of it is enough where others leave the processors alone
  if(CMAKE_CROSSCOMPILING OR NENDO_SANITIZE)
    set(timeout_s 1200)
  endif()
  if(ARG_COMPUTES AND NOT CMAKE_CROSSCOMPILING) # there, an emulator stands in this place
    set_target_properties(${target} PROPERTIES CROSSCOMPILING_EMULATOR "nice;-n;10")
  endif()
  doctest_discover_tests(${target} TEST_PREFIX "${name}/"
    PROPERTIES TIMEOUT ${timeout_s} RUN_SERIAL ${ARG_ALONE} FAIL_REGULAR_EXPRESSION "test cases: +0 ")
endfunction()

# nendo_fuzz(<name> SOURCE ... LIBRARIES ...): a libFuzzer program fuzz_<name>; runs over its corpus in
# tests/fuzz/<name>/. Clang only.
function(nendo_fuzz name)
  cmake_parse_arguments(ARG "" "SOURCE" "LIBRARIES;INCLUDES" ${ARGN})
  set(target fuzz_${name})
  add_executable(${target} ${ARG_SOURCE})
  nendo_settings(${target} PRIVATE)
  target_compile_options(${target} PRIVATE -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all)
  target_link_options(${target} PRIVATE -fsanitize=fuzzer,address,undefined)
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES})
  target_include_directories(${target} PRIVATE ${ARG_INCLUDES})
  add_dependencies(fuzz_targets ${target})
endfunction()
