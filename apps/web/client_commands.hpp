#pragma once
// A strict parser for the commands that a client may send, and the settings as text in both
// directions (PROTOCOL.md). The latter are made from the description of the settings
// (flow/setting.hpp).
// The table of commands and the description of the settings, as the page and other clients have
// them.

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/loop_settings.hpp>

#include "commands/commands.hpp"

namespace nendo::web {

/// The settings that a client names. It does not change the others.
struct NamedSettings {
  flow::LoopSettings values;
  std::uint32_t named = 0; ///< bit k: the k-th setting of flow::for_each_setting()

  /// Gives these settings the values of those that are named.
  void apply_to(flow::LoopSettings& settings) const noexcept;

  friend bool operator==(const NamedSettings&, const NamedSettings&) = default;
};

/// Reads a text such as "mode=type2 radius_m=0.1,0.1,0.1,0.1,0.05", with single spaces between.
/// Allocates only for an error. Error: bad_input, naming the setting and what can be used.
Result<NamedSettings> parse_named_settings(std::string_view text);

/// Returns such a text, which has all settings. Allocates.
std::string text_of(const flow::LoopSettings& settings);

/// A command; or a row of the table, which a client gives by its name as a person does by its key:
/// what becomes of it depends on the run (commands::press()); or the settings that a client
/// changes.
using ClientCommand = std::variant<flow::Command, const commands::Row*, NamedSettings>;

/// Returns the command that the text means. The quaternion of a wrist is normalised. Allocates only
/// for an error. Error: bad_input (it is no command, or a number in it is out of range), in at most
/// max_close_reason bytes.
Result<ClientCommand> parse_command(std::string_view text);

/// Returns the rows that the page has, as a list in JavaScript, of which each has name, keys, help,
/// button, buttonOn, isForRun and isSetting.
std::string page_commands();

/// Returns an object in JavaScript with the settings by their names, of which each has label, and
/// if it is chosen by a slider, min and max. The brushes have choices.
std::string page_settings();

/// Returns the text of the message about commands: a line for each that is on or not possible, in
/// the order of the table. It has the command's name, "on" or "off", and why the command is not
/// possible, with tabs between.
std::string command_states(const commands::Situation& now);

} // namespace nendo::web
