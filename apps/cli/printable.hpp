#pragma once
// Text that came from a device, fit for a terminal and for a table.

#include <algorithm>
#include <string>

namespace nendo::cli {

/// Everything but printable ASCII becomes '?': no escape sequence of a device's reaches a terminal.
inline std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

} // namespace nendo::cli
