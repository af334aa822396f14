#pragma once
// A list of all commands of a window with their keys, found by words of their names and their help
// (F3, ?).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "commands/commands.hpp"

namespace nendo::viewer {

class CommandSearch {
public:
  void open() noexcept { is_asked_ = true; }
  /// Draws the list, if it is open, and below it `mouse`, the mouse actions of the window. `now` is
  /// a commands::Situation or, for a timeline, commands::EditFacts. Returns the row that was
  /// chosen; null: none.
  template <class Now>
  const commands::Row* draw(std::uint8_t places, const Now& now, const char* mouse);

private:
  std::array<char, 64> text_{};
  std::size_t chosen_ = 0; ///< an index of the shown rows
  bool is_asked_ = false;
};

/// Returns whether each word of `text` is in the row's name or help, whatever its case.
bool fits(const commands::Row& row, std::string_view text);

} // namespace nendo::viewer
