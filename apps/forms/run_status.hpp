#pragma once
// What the status bar of a run says, in the window and on the page.

#include <string>
#include <vector>

#include <nendo/flow/frame.hpp>

namespace nendo::forms {

struct StatusItem {
  std::string text;
  const char* help;
};
/// Returns what the loop does and how the hands' samples are: "left 8 ms".
std::vector<StatusItem> status_items(const flow::Frame& frame, double rate_hz,
                                     std::size_t vertices);
/// Returns a volume in model units as text: "12.3 cm3".
std::string volume_text(const flow::Frame& frame, double volume);

} // namespace nendo::forms
