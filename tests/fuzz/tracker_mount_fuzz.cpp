// Whatever the text is, parse_mount gives an error or a mount that can be written, and reads back
// to the same bits.

#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/hand/tracker_mount.hpp>

#include "laws.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  const auto mount = nendo::hand::parse_mount(text, "fuzz");
  if (!mount) {
    require_one_line(mount.error());
    return 0;
  }
  require(nendo::hand::wrist_mount(*mount).T_station_wrist.matrix().allFinite());
  const auto written = nendo::hand::mount_text(*mount);
  require(static_cast<bool>(written));
  const auto back = nendo::hand::parse_mount(*written, "back");
  require(back && *back == *mount && nendo::hand::mount_text(*back).operator*() == *written);
  return 0;
}
