#include "viewer/panel.hpp"

#include <string_view>

#include "viewer/key_list.hpp"
#include "viewer/row_keys.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

void LiveWindow::Panel::ask(const commands::Row& row, const commands::Situation& now,
                            Commands& commands) {
  const commands::Answer answer = commands::press(row, now, wanted);
  if (answer.command) commands.push_back(*answer.command);
  note = answer.refusal != nullptr ? answer.refusal : "";
}

/// What the window obeys by itself.
void LiveWindow::Panel::obey(std::string_view name, SceneWindow& window, PuppetEditor& editor,
                             Commands& commands) {
  if (name == "list keys") keys_shown = !keys_shown;
  if (name == "frame all") window.frame_all();
  if (name == "fold panel") fold_asked = true;
  if (name == "edit puppet") editor.turn(!editor.is_on());
  if (name == "paint masks") editor.is_on() ? editor.toggle_brush() : editor.toggle_masks();
  if (!editor.is_on()) return;
  if (editor.brushes() && !editor.rig().puppet().is_played()) {
    if (name == "forget place") editor.toggle_masks();
    if (name == "delete point") commands.emplace_back(flow::SetMask{flow::MaskEdit::clear});
    return;
  }
  if (name == "mirror puppet") editor.toggle_mirror();
  if (name == "pin point") editor.toggle_pin();
  if (name == "delete point") editor.remove_point();
  if (name == "forget place") editor.forget_place();
}

void LiveWindow::Panel::keys(const commands::Situation& now, SceneWindow& window,
                             PuppetEditor& editor, Commands& commands) {
  if (takes_keys()) {
    window.follow_part_keys();
    window.follow_view_keys();
    for (const commands::Row& row : commands::table()) {
      if ((row.places & commands::in_window) == 0 || !is_struck(row)) continue;
      if (row.is_for_run())
        ask(row, now, commands);
      else
        obey(row.name, window, editor, commands);
    }
  }
  if (keys_shown)
    draw_key_list(commands::in_window,
                  "right drag on a hand moves it, with shift turns it, with the wheel\n"
                  "pushes and pulls it; while a puppet is edited, a click places a point, a\n"
                  "drag of a point tells where it goes, with shift how it turns, the wheel over\n"
                  "one how far it reaches",
                  keys_shown);
}

} // namespace nendo::viewer
