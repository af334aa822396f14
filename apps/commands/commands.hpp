#pragma once
// The table of the commands of a run and of a timeline's editor, with their keys and buttons in the
// terminal, in windows and on the page. Lists of keys, the protocol and the manual are made from
// it.

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

/// Facts of a run that its frames do not have.
struct RunFacts {
  bool recorded = false;   ///< to a file
  bool can_mark = false;   ///< there is a recording, to a file or in memory
  bool keeps_last = false; ///< --keep-last
  bool has_layers = false; ///< gloves play some joints over a recording, or over other gloves
};
/// The state of a run at the time of a command.
struct Situation {
  const flow::Frame& frame; ///< the latest
  const RunFacts& facts;
};

// Where a command can be given; the bits are combined.
inline constexpr std::uint8_t in_terminal = 1, in_window = 2, on_page = 4, in_timeline = 8;
inline constexpr std::uint8_t everywhere = in_terminal | in_window | on_page;

/// Where a button is: `more` is among the settings, and those from `head` on are of a timeline.
enum class Buttons : std::uint8_t { none, hands, model, more, head, key, whole, file };

/// One command. It has `make`, `choose` or `edit`, or is executed by the window or the page itself.
struct Row {
  std::string_view name; ///< the text that a client sends, too (PROTOCOL.md)
  /// The first is shown first. Capitals are typed with shift, and only those of one character, but
  /// for `?`, can be typed in the terminal. Rows share a key only if they are for different places,
  /// and then they share all keys and the first word of their names.
  std::array<std::string_view, 3> keys;
  std::string_view help; ///< one sentence
  std::string_view button{};
  std::string_view button_on{}; ///< while is_on(); empty: as button
  Buttons group = Buttons::none;
  std::uint8_t places = everywhere;
  bool repeats = false; ///< while the key is held down in the window
  /// Makes the command. `on`: is_on(), and the command ends that.
  flow::Command (*make)(bool on) = nullptr;
  void (*choose)(flow::WantedSettings& wanted, const flow::Frame& frame) = nullptr;
  std::optional<Edit> edit{};
  bool (*is_on)(const Situation& now) = nullptr;
  /// Returns why the command is not possible now, as a sentence; null: it is possible.
  const char* (*refusal)(const Situation& now) = nullptr;
  /// Returns whether a window shows the button; null: it does.
  bool (*is_shown)(const Situation& now) = nullptr;

  /// Returns whether the run executes it, and not the window or the page.
  constexpr bool is_for_run() const noexcept { return make != nullptr || choose != nullptr; }
  bool is_on_in(const Situation& now) const { return is_on != nullptr && is_on(now); }
  /// Returns null if the command is possible.
  const char* refusal_in(const Situation& now) const {
    return refusal != nullptr ? refusal(now) : nullptr;
  }
  bool is_on_in(const EditFacts& now) const {
    return edit && edit->is_on != nullptr && edit->is_on(now);
  }
  const char* refusal_in(const EditFacts& now) const {
    return edit && edit->refusal != nullptr ? edit->refusal(now) : nullptr;
  }
  constexpr bool has_key(std::string_view key) const noexcept {
    for (const std::string_view one : keys)
      if (!one.empty() && one == key) return true;
    return false;
  }
};

std::span<const Row> table() noexcept;
/// Returns the row of that name, or with that key in one of the places; null: there is none.
const Row* named(std::string_view name) noexcept;
const Row* with_key(std::string_view key, std::uint8_t places) noexcept;
/// Returns the name of the row that makes the command, whatever its numbers are, such as "wire";
/// "role", or "a command", if no row makes it.
std::string_view name_of(const flow::Command& command) noexcept;
/// Returns the row of that command; each one has a row.
const Row& row_of(EditCommand command) noexcept;

/// The effect of a key or a button.
struct Answer {
  std::optional<flow::Command> command;
  /// Why it is not possible, as a sentence; or null. A flow::Request is a command even so, because
  /// the loop may be a few ticks ahead of the frame.
  const char* refusal = nullptr;
};
/// Returns the command of a row that is_for_run(). `wanted` belongs to the caller, and has followed
/// the frame. Does not allocate.
Answer press(const Row& row, const Situation& now, flow::WantedSettings& wanted);

// Reasons, for code that gets the same command without the table.
inline constexpr const char* no_layers = "The gloves play whole hands here, and no layer; --layer "
                                         "and --over make one.";
inline constexpr const char* no_puppet = "There is no puppet here, and fingertips touch the model; "
                                         "l releases it.";
inline constexpr const char* no_part =
    "No hand has taken a part of this model yet; take the one that "
    "is meant, in mode parts (m).";
inline constexpr const char* no_recording = "There is no recording to mark; begin one with t.";
inline constexpr const char* nothing_kept = "Nothing is kept in memory; start with --keep-last "
                                            "60s.";

/// Returns the keys of a row with commas between: "u, Ctrl Z".
std::string keys_of(const Row& row);
/// Returns a list of the keys in one of the places, for a terminal or a manual page: each row's
/// keys and its sentence, with this text before and between them.
std::string key_list(std::uint8_t places, std::string_view before, std::string_view between);

} // namespace nendo::commands
