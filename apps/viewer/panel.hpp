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

/// The latest values of a quantity, for a strip chart.
class Strip {
public:
  void add(float value) noexcept {
    values_[next_] = value;
    next_ = (next_ + 1) % values_.size();
  }
  const float* data() const noexcept { return values_.data(); }
  int size() const noexcept { return static_cast<int>(values_.size()); }
  int oldest() const noexcept { return static_cast<int>(next_); }
  float most() const noexcept;

private:
  std::array<float, 240> values_{};
  std::size_t next_ = 0;
};

struct LiveWindow::Panel {
  flow::PendingSettings pending;
  SettingControls settings;
  CommandSearch search;
  ValueGesture gesture;
  Strip late_ms, gap_ms, pictures_ms;
  std::uint64_t history_shown = 0; ///< the list's version
  bool fold_asked = false;
  bool folded = false;
  std::string note;    ///< replaces Gauges::report until the next command
  std::string message; ///< in the status bar; empty: the loop's state

  /// Returns the width that the panel covers at the window's left.
  int covered_px() const;
  void follow_settings(const flow::LoopSettings& current);
  void follow(const flow::Frame& frame, double rate_hz);
  /// Draws the panel, and the history beside it.
  void draw(const flow::Frame& frame, const Gauges& gauges, SceneWindow& window,
            PuppetEditor& editor, Commands& commands);
  /// Handles keys, and draws the list of commands.
  void keys(const commands::Situation& now, SceneWindow& window, PuppetEditor& editor,
            Commands& commands);

private:
  void sections(const flow::Frame& frame, const Gauges& gauges, SceneWindow& window,
                PuppetEditor& editor, Commands& commands);
  /// Draws the buttons of a group, two per line.
  void buttons_of(commands::Buttons group, const commands::Situation& now, Commands& commands);
  static void parts(SceneWindow& window);
  /// Lists the history's steps, where the window is wide in a panel of their own. A click undoes or
  /// redoes up to a step.
  void draw_history(const flow::Frame& frame, float top, Commands& commands);
  void history(const flow::Frame& frame, Commands& commands);
  /// Controls symmetry, and masks of fingertips.
  void masks(PuppetEditor& editor, const commands::Situation& now, Commands& commands);
  /// Edits the puppet.
  static void puppet(PuppetEditor& editor, const flow::Frame& frame, Commands& commands);
  static void clay(const flow::Frame& frame);
  void timing(const flow::Frame& frame) const;
  static void hands(const flow::Frame& frame, const Gauges& gauges);
  void ask(const commands::Row& row, const commands::Situation& now, Commands& commands);
  /// Begins to change a radius, or the strength, by the pointer.
  void begin_gesture(const commands::Row& row, const commands::Situation& now,
                     const SceneWindow& window, PuppetEditor& editor);
  void execute(std::string_view name, SceneWindow& window, PuppetEditor& editor,
               Commands& commands);
};

} // namespace nendo::viewer
