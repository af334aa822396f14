#pragma once
// The table of all commands of runs and of the timeline editor, with keys and buttons for the
// terminal, windows and the web page. Key lists, the protocol and the manual are generated from it.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>

#include "commands/edit_command.hpp"

namespace nendo::commands {

/// Facts about a run that are not in its frames.
struct RunFacts {
  bool recorded = false;   ///< a recording to a file is active
  bool can_mark = false;   ///< a recording, to a file or in memory, is active
  bool keeps_last = false; ///< --keep-last
  bool has_layers = false; ///< gloves play some joints over a recording, or over other gloves
};
/// The state of a run at the time of a command.
struct Situation {
  const flow::Frame& frame; ///< the latest
  const RunFacts& facts;
};

/// That of a run or of the timeline editor, which must outlive it.
struct State {
  State(const Situation& of_run) noexcept : run(&of_run) {}
  State(const EditFacts& of_edit) noexcept : edit(&of_edit) {}
  const Situation* run = nullptr;
  const EditFacts* edit = nullptr;
};

// The places where a command is available, as bits.
inline constexpr std::uint8_t in_terminal = 1, in_window = 2, on_page = 4, in_timeline = 8;
inline constexpr std::uint8_t everywhere = in_terminal | in_window | on_page;

/// The group of a button. `more` is among the settings; `head` and later groups are in the timeline
/// editor.
enum class Buttons : std::uint8_t { none, hands, model, more, head, key, whole, file };

/// One command. It has `make`, `choose` or `edit`; otherwise the window or the page executes it.
struct Row {
  std::string_view name; ///< also the text that a client sends (PROTOCOL.md)
  /// The keys, the preferred one first. Capitals need shift. The terminal has only keys of one
  /// character, except `?`. Rows that share a key have different places, the same keys, and the
  /// same first word in their names.
  std::array<std::string_view, 3> keys;
  std::string_view help; ///< one sentence
  std::string_view button{};
  std::string_view button_on{}; ///< the label while is_on(); empty: as `button`
  Buttons group = Buttons::none;
  std::uint8_t places = everywhere;
  bool repeats = false; ///< the key repeats while it is held down
  /// The setting that it changes (flow::SettingText::name); empty: none, or several.
  std::string_view setting{};
  /// Makes the command. `on`: is_on(), which the command then turns off.
  flow::Command (*make)(bool on) = nullptr;
  void (*choose)(flow::PendingSettings& pending, const flow::Frame& frame) = nullptr;
  std::optional<Edit> edit{};
  bool (*is_on)(const Situation& now) = nullptr;
  /// Returns why the command is not possible now, as a sentence; null: it is possible.
  const char* (*refusal)(const Situation& now) = nullptr;
  /// Returns whether a window shows the button; null: always.
  bool (*is_shown)(const Situation& now) = nullptr;

  /// Returns whether the run executes it, not the window or the page.
  constexpr bool is_for_run() const noexcept { return make != nullptr || choose != nullptr; }
  bool is_on_in(const State& now) const {
    if (now.run != nullptr) return is_on != nullptr && is_on(*now.run);
    return edit && edit->is_on != nullptr && edit->is_on(*now.edit);
  }
  /// Returns null if the command is possible.
  const char* refusal_in(const State& now) const {
    if (now.run != nullptr) return refusal != nullptr ? refusal(*now.run) : nullptr;
    return edit && edit->refusal != nullptr ? edit->refusal(*now.edit) : nullptr;
  }
  constexpr bool has_key(std::string_view key) const noexcept {
    for (const std::string_view one : keys)
      if (!one.empty() && one == key) return true;
    return false;
  }
};

std::span<const Row> table() noexcept;
/// Return the row of that name, or with that key in one of the places; null: none.
const Row* named(std::string_view name) noexcept;
const Row* with_key(std::string_view key, std::uint8_t places) noexcept;
/// Returns the name of the row that makes this type of command, such as "wire"; without a row,
/// "role" or "a command".
std::string_view name_of(const flow::Command& command) noexcept;
/// Every command has a row.
const Row& row_of(EditCommand command) noexcept;

/// The effect of a key or a button.
struct Answer {
  std::optional<flow::Command> command;
  /// Why it is not possible, as a sentence; null: it is possible. A refused flow::Request still has
  /// a command, because the loop may be some ticks ahead of the frame.
  const char* refusal = nullptr;
};
/// Returns the command of a row that is_for_run(). `pending` is the caller's, after follow() with
/// the frame. Does not allocate.
Answer press(const Row& row, const Situation& now, flow::PendingSettings& pending);

// Refusals, for code that gets these commands without the table.
inline constexpr const char* no_layers = "The gloves play whole hands here, and no layer; --layer "
                                         "and --over make one.";
inline constexpr const char* no_puppet = "There is no puppet here, and fingertips touch the model; "
                                         "l releases it.";
inline constexpr const char* no_part =
    "No hand has taken a part of this model yet; take the one that "
    "is meant, in mode parts (m).";
inline constexpr const char* no_radius =
    "Fingertips have radii in Pull and Strokes, not in this mode; m chooses the next one.";
inline constexpr const char* no_strength =
    "Only brushes other than pull have a strength, in Strokes and without a puppet; w chooses one.";
inline constexpr const char* no_trackers = "No tracker moves a hand here; start with --left-wrist "
                                           "or --right-wrist.";
inline constexpr const char* no_recording = "There is no recording to mark; begin one with t.";
inline constexpr const char* nothing_kept = "Nothing is kept in memory; start with --keep-last "
                                            "60s.";

/// A hint for the first start, in the window and on the page.
struct Hint {
  std::string_view keys, text;
};
inline constexpr std::array hints{
    Hint{"g, l", "The hands grab the model, and release it."},
    Hint{"u, r", "Undo and redo; a click in the history goes to any step."},
    Hint{"drag", "Turns the view; with shift it shifts it, and the wheel zooms."},
};

/// Returns the keys of a row, separated by commas: "u, Ctrl Z".
std::string keys_of(const Row& row);
/// Returns the tooltip of a row: its help, why it is not possible now, and its keys.
std::string help_of(const Row& row, const State& now);
/// Returns the key list of a place, for a terminal or a manual page. `before` precedes each row's
/// keys, and `between` its sentence.
std::string key_list(std::uint8_t places, std::string_view before, std::string_view between);

} // namespace nendo::commands
