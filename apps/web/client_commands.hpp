#pragma once
// A strict parser for clients' commands and settings (PROTOCOL.md), by the descriptions in
// flow/setting.hpp; commands/command_text.hpp writes both. Also the command table and the settings
// for the page and other clients.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/loop_settings.hpp>

#include "commands/commands.hpp"

namespace nendo::web {

/// The settings that a client changes.
struct NamedSettings {
  flow::LoopSettings values;
  std::uint32_t named = 0; ///< bit k: the k-th setting of flow::for_each_setting()

  /// Copies the named values to `settings`.
  void apply_to(flow::LoopSettings& settings) const noexcept;

  friend bool operator==(const NamedSettings&, const NamedSettings&) = default;
};

/// Parses a text such as "mode=type2 radius_m=0.1,0.1,0.1,0.1,0.05", separated by single spaces.
/// Allocates only for an error. Error: bad_input, naming the setting and its valid values.
Result<NamedSettings> parse_named_settings(std::string_view text);

/// A command; or a row of the table, by its name, whose effect depends on the run
/// (commands::press()); or changed settings.
using ClientCommand = std::variant<flow::Command, const commands::Row*, NamedSettings>;

/// Parses a command. Normalises the quaternion of a wrist. Allocates only for an error. Error:
/// bad_input (not a command, or a number out of range), in at most max_close_reason bytes.
Result<ClientCommand> parse_command(std::string_view text);

/// The forms of a page (PROTOCOL.md, message 12): of a screen, of the run, and its status bar,
/// which takes no input.
enum class FormKind : std::uint8_t { screen, run, status };
inline constexpr std::size_t form_kinds = 3;

/// What the pointer did in a drawing of a form. The numbers are finite, and at most max_number.
struct PointerInput {
  static constexpr double max_number = 1e5;
  /// `size`: the drawing's line has got a width, which is x. `drag`: a move with the main button.
  enum class Event : std::uint8_t { size, leave, move, down, drag, up };
  Event event = Event::move;
  double x = 0.0; ///< px, from the drawing's top left corner
  double y = 0.0;
  double panned = 0.0; ///< px to the right with the middle button, since the previous event
  double wheel = 0.0;  ///< steps since the previous event; positive: away from the user
  bool has_control = false;
};

/// What a user did to a control of a form.
struct FormInput {
  std::string control; ///< its id
  std::string value;   ///< the new value; empty for buttons and the pointer
  FormKind form = FormKind::screen;
  std::optional<PointerInput> pointer{};

  /// Takes in the next input of the form, if both have the effect of one: the last value of a
  /// slider, or the sum of moves. Presses and releases remain. Returns whether it did.
  bool take_in(const FormInput& next);
};
/// Parses "form" or, for the run's, "panel", an id and a value, separated by tabs. For a drawing
/// the value is an event, a tab and five numbers. Error: bad_input, in at most max_close_reason
/// bytes.
Result<FormInput> parse_form_input(std::string_view text);

/// Returns the page's rows as a JavaScript array of objects with name, keys, help, button,
/// isForRun, isEdit, inRun, inTimeline and repeats.
std::string page_commands();

/// Returns the hints for the first start as a JavaScript array of objects with keys and text.
std::string page_hints();

/// Returns the text of the commands message: a line for each command that is on, not possible, or
/// without a button, in table order, with name, "on", "off" or "hidden", and refusal, separated by
/// tabs.
std::string command_states(const commands::Situation& now);

} // namespace nendo::web
