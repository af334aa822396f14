#pragma once
// The contents of the live window's panel.

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <nendo/flow/command.hpp>

#include "commands/commands.hpp"
#include "viewer/command_search.hpp"
#include "viewer/live_window.hpp"
#include "viewer/puppet_editor.hpp"
#include "viewer/setting_controls.hpp"
#include "viewer/value_gesture.hpp"

namespace nendo::viewer {

/// The latest values of a quantity, the newest last, for a strip chart.
struct Strip : std::array<float, 240> {
  void add(float value) noexcept;
};

struct LiveWindow::Panel {
  Panel(SceneWindow& shown_in, PuppetEditor& edits) : window(shown_in), editor(edits) {}

  SceneWindow& window;
  PuppetEditor& editor;
  Commands commands; ///< asked for in this picture
  flow::PendingSettings pending;
  SettingControls settings;
  CommandSearch search;
  ValueGesture gesture;
  Strip late_ms{}, gap_ms{}, pictures_ms{};
  std::uint64_t history_shown = 0; ///< the list's version
  bool hints = false;              ///< are shown over the picture
  bool fold_asked = false;
  bool folded = false;
  std::string note;    ///< replaces Gauges::report until the next command
  std::string message; ///< in the status bar; may be empty

  /// Returns the width that the panel covers at the window's left.
  int covered_px() const;
  void follow_settings(const flow::LoopSettings& current);
  void follow(const flow::Frame& frame, double rate_hz);
  /// Draws the panel, the history beside it, the status bar and the list of commands, and handles
  /// keys.
  void draw(const flow::Frame& frame, const Gauges& gauges);

private:
  void draw_tools(const flow::Frame& frame, const Gauges& gauges, float top);
  void sections(const flow::Frame& frame, const Gauges& gauges);
  /// Draws the buttons of a group, two per line.
  void buttons_of(commands::Buttons group, const commands::Situation& now);
  void parts();
  /// Lists the history's steps, where the window is wide in a panel of their own. A click undoes or
  /// redoes up to a step.
  void draw_history(const flow::Frame& frame, float top);
  void history(const flow::Frame& frame);
  void go_to_step(const flow::StepList& list, std::size_t at);
  /// Controls symmetry, and masks of fingertips.
  void masks(const commands::Situation& now);
  /// Edits the puppet.
  void puppet(const flow::Frame& frame);
  void puppet_buttons();
  static void clay(const flow::Frame& frame);
  void timing(const flow::Frame& frame) const;
  static void hands(const flow::Frame& frame, const Gauges& gauges);
  void draw_hints();
  /// Executes a command, here or by the run.
  void take(const commands::Row& row, const commands::Situation& now);
  void ask(const commands::Row& row, const commands::Situation& now);
  /// Begins to change a radius, or the strength, by the pointer.
  void begin_gesture(const commands::Row& row, const commands::Situation& now);
  double metres_of_pixel(const flow::Frame& frame) const;
  void execute(std::string_view name);
};

} // namespace nendo::viewer
