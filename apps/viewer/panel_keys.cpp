#include "viewer/panel.hpp"

#include <utility>

#include "viewer/key_list.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

using flow::Request;

namespace {

constexpr std::array key_table{
    KeyLine{"g", "grab: the hands take hold"},
    KeyLine{"l", "let go; what is shaped stays"},
    KeyLine{"a", "take hold anew where the hands are, without a commit"},
    KeyLine{"c", "commit: this shape becomes the rest shape"},
    KeyLine{"u, ctrl z", "undo the last step"},
    KeyLine{"r, ctrl y", "redo what was undone; ctrl shift z, too"},
    KeyLine{"x", "reset: back to the model as it was loaded"},
    KeyLine{"t", "a take: record from here on, and end that"},
    KeyLine{",, '", "of a puppet: the left hand, the right hand lets go, takes hold again"},
    KeyLine{"y", "symmetry: one hand shapes both sides, or plays both of a puppet"},
    KeyLine{"z, shift z", "paint masks: what fingertips leave alone; invert them"},
    KeyLine{"Tab", "the puppet: edit it with the mouse, or play it"},
    KeyLine{"j, o, z", "while it is edited: mirror, pin, the brush for masks"},
    KeyLine{"Delete, a", "the chosen point goes, or all masks; save the puppet, or the masks"},
    KeyLine{".", "mark this moment in the recording"},
    KeyLine{"o", "overdub: the gloves' layer comes in, or goes out (--over, --layer)"},
    KeyLine{"k", "keep the recording of what was just done (--keep-last)"},
    KeyLine{"s", "save the model as it is now"},
    KeyLine{"m, n", "the next mode, the next kernel"},
    KeyLine{"[, ]", "smaller radii, larger ones"},
    KeyLine{"w", "the next brush of type 2"},
    KeyLine{"-, =", "a weaker brush, a stronger one; below 0 the opposite"},
    KeyLine{"i", "the surface never folds, or may"},
    KeyLine{";", "more clay: the volume stays; from all to air"},
    KeyLine{"j", "the whole hand holds, or its fingertips"},
    KeyLine{"e", "subdivide: the model gets more vertices for finer strokes"},
    KeyLine{"shift e", "refine: more triangles where it was stretched, fewer where it was crowded"},
    KeyLine{"shift c, shift k", "begins to draw a wire, a knife, and then cuts by it"},
    KeyLine{"shift j", "joins parts that overlap"},
    KeyLine{"shift o", "thin necks part, thin walls open, and what is as near fuses"},
    KeyLine{"shift d, shift x", "copies, removes the part that was taken last"},
    KeyLine{"Home", "all of the model and the hands in the picture"},
    KeyLine{"p", "the panel folded and unfolded"},
    KeyLine{"q", "quit; the shape is written"},
};

} // namespace

void LiveWindow::Panel::settings_keys(const flow::Frame& frame) {
  if (pressed(GLFW_KEY_M)) wanted.next_mode(frame.function_count > 0);
  if (pressed(GLFW_KEY_N)) wanted.next_kernel();
  if (pressed(GLFW_KEY_LEFT_BRACKET, true)) wanted.reduce_radii();
  if (pressed(GLFW_KEY_RIGHT_BRACKET, true)) wanted.enlarge_radii();
  if (pressed(GLFW_KEY_I)) wanted.toggle_folding();
  if (pressed(GLFW_KEY_W)) wanted.next_brush();
  if (pressed(GLFW_KEY_MINUS, true)) wanted.weaken();
  if (pressed(GLFW_KEY_EQUAL, true)) wanted.strengthen();
}

// The page's button is grey then, too; a key says why nothing happens.
void LiveWindow::Panel::step(Request request, const flow::Frame& frame, Commands& commands) {
  const bool undoes = request == Request::undo;
  if ((undoes ? frame.undo_steps : frame.redo_steps) > 0) {
    commands.emplace_back(request);
  } else {
    note = undoes ? "There is nothing to undo." : "There is nothing to redo.";
  }
}

void LiveWindow::Panel::keys(const flow::Frame& frame, const Gauges& gauges, SceneWindow& window,
                             Commands& commands) {
  const std::size_t before = commands.size();
  if (takes_keys()) {
    window.follow_part_keys();
    window.follow_view_keys();
    if (ImGui::GetIO().KeyCtrl) {
      step_keys(frame, commands);
    } else {
      single_keys(frame, gauges, window, commands);
    }
  }
  if (commands.size() > before) note.clear();
  if (keys_shown)
    draw_key_list(key_table,
                  "right drag on a hand moves it, with shift turns it, with the wheel\n"
                  "pushes and pulls it; while a puppet is edited, a click places a point, a\n"
                  "drag of a point tells where it goes, with shift how it turns, the wheel over\n"
                  "one how far it reaches",
                  keys_shown);
}

// With ctrl.
void LiveWindow::Panel::step_keys(const flow::Frame& frame, Commands& commands) {
  if (pressed(GLFW_KEY_Z, true))
    step(ImGui::GetIO().KeyShift ? Request::redo : Request::undo, frame, commands);
  if (pressed(GLFW_KEY_Y, true)) step(Request::redo, frame, commands);
}

// With shift: what cuts the model and is done with its parts.
void LiveWindow::Panel::part_keys(const flow::Frame& frame, Commands& commands) {
  const bool draws = frame.wire.is_drawn();
  if (pressed(GLFW_KEY_C)) commands.emplace_back(flow::DrawWire{!draws});
  if (pressed(GLFW_KEY_K)) commands.emplace_back(flow::DrawWire{!draws, flow::Blade::knife});
  if (pressed(GLFW_KEY_J)) commands.emplace_back(flow::JoinParts{});
  if (pressed(GLFW_KEY_O)) commands.emplace_back(flow::ChangeTopology{});
  if (pressed(GLFW_KEY_D)) commands.emplace_back(flow::EditPart{});
  if (pressed(GLFW_KEY_X)) commands.emplace_back(flow::EditPart{true});
}

void LiveWindow::Panel::single_keys(const flow::Frame& frame, const Gauges& gauges,
                                    SceneWindow& window, Commands& commands) {
  const bool shift = ImGui::GetIO().KeyShift;
  for (const auto& [key, request] : {std::pair{GLFW_KEY_G, Request::grab},
                                     {GLFW_KEY_L, Request::let_go},
                                     {GLFW_KEY_C, Request::commit},
                                     {GLFW_KEY_X, Request::reset}})
    if (pressed(key) && !(shift && (key == GLFW_KEY_C || key == GLFW_KEY_X)))
      commands.emplace_back(request);
  if (shift) part_keys(frame, commands);
  if (pressed(GLFW_KEY_U)) step(Request::undo, frame, commands);
  if (pressed(GLFW_KEY_R)) step(Request::redo, frame, commands);
  if (pressed(GLFW_KEY_T)) commands.emplace_back(flow::SetRecording{!gauges.recording});
  for (const auto& [key, side] :
       {std::pair{GLFW_KEY_COMMA, Side::left}, {GLFW_KEY_APOSTROPHE, Side::right}})
    if (pressed(key))
      commands.emplace_back(flow::SetClutch{side, puppet::RigPlayer::all_fingers,
                                            frame.let_go[flow::Placement::index_of(side)]});
  if (pressed(GLFW_KEY_Y)) commands.emplace_back(flow::SetSymmetry{!frame.symmetric});
  if (pressed(GLFW_KEY_PERIOD)) commands.emplace_back(flow::Mark{});
  if (!edits_puppet) { // where these keys have another meaning
    if (pressed(GLFW_KEY_A)) commands.emplace_back(Request::take_hold);
    if (pressed(GLFW_KEY_O) && !shift) commands.emplace_back(flow::Punch{});
    if (pressed(GLFW_KEY_SEMICOLON)) wanted.next_volume();
    if (pressed(GLFW_KEY_J) && !shift) wanted.toggle_hold();
  }
  if (pressed(GLFW_KEY_K) && !shift) commands.emplace_back(flow::SaveRecording{});
  if (pressed(GLFW_KEY_E)) {
    if (ImGui::GetIO().KeyShift)
      commands.emplace_back(flow::Refine{});
    else
      commands.emplace_back(flow::Subdivide{});
  }
  if (pressed(GLFW_KEY_S)) commands.emplace_back(flow::SaveShape{});
  settings_keys(frame);
  if (pressed(GLFW_KEY_Q)) commands.emplace_back(flow::EndRun{});
  if (pressed(GLFW_KEY_SLASH)) keys_shown = !keys_shown;
  if (pressed(GLFW_KEY_HOME)) window.frame_all();
  if (pressed(GLFW_KEY_P)) fold_asked = true;
}

} // namespace nendo::viewer
