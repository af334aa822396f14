// Whatever the text is, the reader of ROS drivers' calibrations in YAML gives an error in one line,
// or finite lines that are written and read back.

#include "imported_calibration.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = nendo::hand::parse_ros_yaml(text_of(data, size), "fuzz");
  check_imported(read);
  if (read) (void)nendo::hand::ros_yaml_text(read->calibration, {});
  return 0;
}
