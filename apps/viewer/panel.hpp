#pragma once
// The contents of the live window's panel.

#include <string>

#include "commands/commands.hpp"
#include "forms/run_panel.hpp"
#include "viewer/command_search.hpp"
#include "viewer/live_window.hpp"
#include "viewer/puppet_editor.hpp"
#include "viewer/value_gesture.hpp"
#include "viewer/window_form.hpp"

namespace nendo::viewer {

struct LiveWindow::Panel final : forms::RunPanel {
  Panel(SceneWindow& shown_in, PuppetEditor& edits)
      : RunPanel(commands::in_window), window(shown_in), editor(edits) {}

  SceneWindow& window;
  PuppetEditor& editor;
  CommandSearch search;
  ValueGesture gesture;
  bool hints = false; ///< are shown over the picture
  bool fold_asked = false;
  bool folded = false;
  std::string message; ///< in the status bar; may be empty

  /// Returns the width that the panel covers at the window's left.
  int covered_px() const;
  void follow(const flow::Frame& frame, double rate_hz);
  /// Draws the panel, the history beside it, the status bar and the list of commands, and handles
  /// keys.
  void draw(const flow::Frame& frame, const Gauges& gauges);

private:
  void draw_tools(const flow::Frame& frame, const Gauges& gauges, float top);
  /// Lists the history's steps in a panel of their own.
  void draw_history(const flow::Frame& frame, float top);
  void puppet_buttons();
  void draw_hints();
  /// Executes a command, here or by the run.
  void take(const commands::Row& row, const commands::Situation& now);
  /// Begins to change a radius, or the strength, by the pointer.
  void begin_gesture(const commands::Row& row, const commands::Situation& now);
  double metres_of_pixel(const flow::Frame& frame) const;

  bool has_history() const override;
  bool edits_puppet() const override { return editor.edits_puppet(); }
  void describe_puppet(forms::Form& form, const flow::Frame& frame) override;
  void describe_look(forms::Form& form, const commands::Situation& now) override;
  void describe_painting(forms::Form& form) override;
  bool is_on(const commands::Row& row) const override;
  void execute(const commands::Row& row) override;

  WindowForm tools_, history_;
};

} // namespace nendo::viewer
