#pragma once
// The commands of the timeline editor.

#include <cstdint>

namespace nendo::commands {

enum class EditCommand : std::uint8_t {
  to_begin,
  previous_key,
  previous_frame,
  play,
  next_frame,
  next_key,
  to_end,
  slower,
  faster,
  loop,
  add_key,
  copy_key,
  delete_key,
  select_none,
  mirror,
  undo,
  redo,
  save,
  export_glb, ///< must be last: the table has a row for each command up to here
};

/// The state of the editor at the time of a command.
struct EditFacts {
  bool playing = false;
  bool can_undo = false;
  bool can_redo = false;
  bool exporting = false;
  bool key_selected = false;
};

/// A row's command of the editor, and its state.
struct Edit {
  EditCommand command;
  /// Returns why the command is not possible now, as a sentence; null: it is possible.
  const char* (*refusal)(const EditFacts& now) = nullptr;
  bool (*is_on)(const EditFacts& now) = nullptr;
};

/// A refusal, for mouse commands without a row.
inline constexpr const char* no_key = "No key is selected; click one on the strip.";

} // namespace nendo::commands
