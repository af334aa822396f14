#pragma once
// The commands that a window is asked for: by their keys, or in a list of all commands, where they
// are found by words of their names and their help (F3, ?).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "commands/commands.hpp"

namespace nendo::viewer {

class CommandSearch {
public:
  /// Handles keys, and draws the list, if it is open, with `mouse`, the mouse actions of the
  /// window, below it. Returns the rows of one of the places that were asked for since the last
  /// picture.
  std::vector<const commands::Row*> asked(std::uint8_t places, const commands::State& now,
                                          const char* mouse);

private:
  const commands::Row* draw(std::uint8_t places, const commands::State& now, const char* mouse);

  std::array<char, 64> text_{};
  std::size_t chosen_ = 0; ///< an index of the shown rows
};

/// Returns whether each word of `text` is in the row's name or help, whatever its case.
bool fits(const commands::Row& row, std::string_view text);

} // namespace nendo::viewer
