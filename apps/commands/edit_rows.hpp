#pragma once
// The rows of the table of commands for a timeline's window, in the order of its buttons.

#include "commands/commands.hpp"

namespace nendo::commands {

/// Makes a row's array. All of it is initialised, or else GCC 12 cannot read it in a static_assert.
consteval std::array<std::string_view, 3> keys(std::string_view first, std::string_view second = {},
                                               std::string_view third = {}) {
  return {first, second, third};
}

/// Makes a row of a timeline's window.
consteval Row edit_row(std::string_view name, const std::array<std::string_view, 3>& keys,
                       std::string_view help, const Edit& edit, Buttons group = Buttons::none,
                       std::string_view button = {}, std::string_view button_on = {}) {
  return {.name = name,
          .keys = keys,
          .help = help,
          .button = button,
          .button_on = button_on,
          .group = group,
          .places = in_timeline,
          .edit = edit};
}
consteval Row repeating(Row row) {
  row.repeats = true;
  return row;
}

constexpr bool is_playing(const EditFacts& now) {
  return now.playing;
}
constexpr const char* without_key(const EditFacts& now) {
  return now.key_selected ? nullptr : no_key;
}
constexpr const char* without_undo(const EditFacts& now) {
  return now.can_undo ? nullptr : "There is nothing to undo.";
}
constexpr const char* without_redo(const EditFacts& now) {
  return now.can_redo ? nullptr : "There is nothing to redo.";
}
constexpr const char* while_exporting(const EditFacts& now) {
  return now.exporting ? "An export of this timeline has not ended yet." : nullptr;
}

inline constexpr std::array edit_rows{
    edit_row("to begin", keys("Ctrl Home"), "Moves the play head to the beginning.",
             {EditCommand::to_begin}, Buttons::head, "|<"),
    edit_row("previous key", keys("Up"), "Moves the play head to the previous key.",
             {EditCommand::previous_key}, Buttons::head, "<<"),
    repeating(edit_row("previous frame", keys("Left"), "Moves the play head to the previous frame.",
                       {EditCommand::previous_frame}, Buttons::head, "<")),
    edit_row("play", keys("Space"), "Plays the timeline, or pauses.",
             {EditCommand::play, nullptr, is_playing}, Buttons::head, "Play", "Pause"),
    repeating(edit_row("next frame", keys("Right"), "Moves the play head to the next frame.",
                       {EditCommand::next_frame}, Buttons::head, ">")),
    edit_row("next key", keys("Down"), "Moves the play head to the next key.",
             {EditCommand::next_key}, Buttons::head, ">>"),
    edit_row("to end", keys("Ctrl End", "End"), "Moves the play head to the end.",
             {EditCommand::to_end}, Buttons::head, ">|"),
    repeating(
        edit_row("slower", keys("Ctrl Down"), "Plays the timeline slower.", {EditCommand::slower})),
    repeating(
        edit_row("faster", keys("Ctrl Up"), "Plays the timeline faster.", {EditCommand::faster})),
    edit_row("loop", keys("L"), "Repeats the timeline, or plays it once.", {EditCommand::loop}),
    edit_row("add key", keys("I"),
             "Adds a key at the play head, to the selected key's hand or else to both hands.",
             {EditCommand::add_key}, Buttons::key, "Add at head"),
    edit_row("copy key", keys("D"), "Copies the selected key to the play head.",
             {EditCommand::copy_key, without_key}, Buttons::key, "Copy to head"),
    edit_row("delete key", keys("Delete", "Backspace"), "Deletes the selected key.",
             {EditCommand::delete_key, without_key}, Buttons::key, "Delete"),
    edit_row("forget key", keys("Esc"), "Cancels a drag, or selects no key.",
             {EditCommand::select_none}),
    edit_row("mirror hands", keys("Y"), "Each hand does what the other one did.",
             {EditCommand::mirror}, Buttons::whole, "Mirror the hands"),
    repeating(edit_row("undo edit", keys("u", "Ctrl Z"), "Undoes the last edit.",
                       {EditCommand::undo, without_undo}, Buttons::file, "Undo")),
    repeating(edit_row("redo edit", keys("r", "Ctrl Y", "Ctrl Shift Z"),
                       "Redoes the edit that was undone last.", {EditCommand::redo, without_redo},
                       Buttons::file, "Redo")),
    edit_row("save timeline", keys("s", "Ctrl S"), "Saves the timeline.", {EditCommand::save},
             Buttons::file, "Save"),
    edit_row("export", keys("Ctrl E"),
             "Exports the timeline as it is now to a .glb file beside it.",
             {EditCommand::export_glb, while_exporting}, Buttons::file, "Export .glb"),
    Row{.name = "end edit",
        .keys = keys("q"),
        .help = "Closes the window; asks first if there are unsaved changes.",
        .places = in_timeline},
};

} // namespace nendo::commands
