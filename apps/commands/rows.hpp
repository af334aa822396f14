#pragma once
// The rows of the command table.

#include <array>

#include <nendo/flow/setting.hpp>

#include "commands/commands.hpp"

namespace nendo::commands {

/// Makes a row's keys. Initialises unused ones, because GCC 12 needs it in a static_assert.
consteval std::array<std::string_view, 3> keys(std::string_view first, std::string_view second = {},
                                               std::string_view third = {}) {
  return {first, second, third};
}

/// Makes a row that may have a button.
consteval Row button_row(std::string_view name, const std::array<std::string_view, 3>& keys,
                         std::string_view help, Buttons group, std::string_view button,
                         std::string_view button_on) {
  return {.name = name,
          .keys = keys,
          .help = help,
          .button = button,
          .button_on = button_on,
          .group = group};
}
/// Makes a row of the timeline editor.
consteval Row edit_row(std::string_view name, const std::array<std::string_view, 3>& keys,
                       std::string_view help, const Edit& edit, Buttons group = Buttons::none,
                       std::string_view button = {}, std::string_view button_on = {}) {
  Row row = button_row(name, keys, help, group, button, button_on);
  row.places = in_timeline;
  row.edit = edit;
  return row;
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

template <flow::Request request>
flow::Command request_of(bool) {
  return request;
}
template <class T>
flow::Command simple(bool) {
  return T{};
}
template <flow::Blade blade>
flow::Command draw(bool on) {
  return flow::DrawWire{!on, blade};
}
template <flow::MaskEdit edit>
flow::Command edit_masks(bool) {
  return flow::SetMask{edit};
}
template <bool removes>
flow::Command edit_part(bool) {
  return flow::EditPart{removes};
}
template <Side side>
flow::Command clutch(bool on) {
  return flow::SetClutch{side, puppet::RigPlayer::all_fingers, !on};
}
template <Side side>
bool plays(const Situation& now) {
  return !now.frame.released[flow::Placement::index_of(side)];
}
template <void (flow::PendingSettings::*change)() noexcept>
void choose(flow::PendingSettings& pending, const flow::Frame&) {
  (pending.*change)();
}

inline bool draws(const Situation& now) {
  return now.frame.wire.is_drawing();
}
inline bool has_parts(const Situation& now) {
  return now.frame.parts.count > 0; // in another mode no hand takes a part
}
inline const char* without_puppet(const Situation& now) {
  return now.frame.function_count == 0 ? no_puppet : nullptr;
}
inline const char* without_trackers(const Situation& now) {
  const auto& hands = now.frame.hands;
  return hands[0].tracked || hands[1].tracked ? nullptr : no_trackers;
}
inline const char* without_part(const Situation& now) {
  return now.frame.parts.chosen == deform::no_index ? no_part : nullptr;
}

inline const char* nothing_to_undo(const Situation& now) {
  return now.frame.undo_steps == 0 ? "There is nothing to undo." : nullptr;
}
inline const char* nothing_to_redo(const Situation& now) {
  return now.frame.redo_steps == 0 ? "There is nothing to redo." : nullptr;
}
inline const char* without_hold(const Situation& now) {
  return now.frame.held ? nullptr : "The hands do not hold the model.";
}
inline const char* without_kept_input(const Situation& now) {
  return now.facts.keeps_last ? nullptr : nothing_kept;
}
inline flow::Command toggle_recording(bool on) {
  return flow::SetRecording{!on};
}
inline bool is_recorded(const Situation& now) {
  return now.facts.recorded;
}
inline bool can_mark(const Situation& now) {
  return now.facts.can_mark;
}
inline const char* without_recording(const Situation& now) {
  return now.facts.can_mark ? nullptr : no_recording;
}
inline bool has_layers(const Situation& now) {
  return now.facts.has_layers;
}
inline const char* without_layers(const Situation& now) {
  return now.facts.has_layers ? nullptr : no_layers;
}
inline const char* without_other_part(const Situation& now) {
  if (const char* const none = without_part(now)) return none;
  return now.frame.parts.count > 1 ? nullptr : "The model has no other part.";
}
inline const char* without_radius(const Situation& now) {
  return flow::setting::radius.works_in(now.frame.settings.mode) ? nullptr : no_radius;
}
inline const char* without_strength(const Situation& now) {
  const flow::LoopSettings& settings = now.frame.settings;
  const bool has_effect = flow::setting::brush_strength.works_in(settings.mode) &&
                          flow::setting::has_brush(settings) && now.frame.function_count == 0;
  return has_effect ? nullptr : no_strength;
}
inline flow::Command toggle_symmetry(bool on) {
  return flow::SetSymmetry{!on};
}
inline bool is_symmetric(const Situation& now) {
  return now.frame.symmetric;
}
inline void choose_next_mode(flow::PendingSettings& pending, const flow::Frame& frame) {
  pending.next_mode(frame.function_count > 0);
}

/// Makes a row that the run executes.
consteval Row run_row(std::string_view name, const std::array<std::string_view, 3>& keys,
                      std::string_view help, flow::Command (*make)(bool on),
                      Buttons group = Buttons::none, std::string_view button = {},
                      std::string_view button_on = {}) {
  Row row = button_row(name, keys, help, group, button, button_on);
  row.make = make;
  return row;
}
/// Makes a row that changes a setting of a run.
consteval Row setting_row(const flow::SettingText& setting, std::string_view name,
                          const std::array<std::string_view, 3>& keys, std::string_view help,
                          void (*choose)(flow::PendingSettings& pending,
                                         const flow::Frame& frame)) {
  return {.name = name, .keys = keys, .help = help, .setting = setting.name, .choose = choose};
}
/// Makes a row that the window or the page executes itself.
consteval Row own_row(std::string_view name, const std::array<std::string_view, 3>& keys,
                      std::string_view help, std::uint8_t places) {
  return {.name = name, .keys = keys, .help = help, .places = places};
}
/// Makes a row of the window that changes a setting by the pointer.
consteval Row value_row(const flow::SettingText& setting, std::string_view name,
                        const std::array<std::string_view, 3>& keys, std::string_view help) {
  Row row = own_row(name, keys, help, in_window);
  row.setting = setting.name;
  return row;
}
inline constexpr std::uint8_t in_views = in_window | on_page | in_timeline;

consteval Row on_if(Row row, bool (*is_on)(const Situation& now)) {
  row.is_on = is_on;
  return row;
}
consteval Row refused_if(Row row, const char* (*refusal)(const Situation& now)) {
  row.refusal = refusal;
  return row;
}
consteval Row shown_at(Row row, std::uint8_t places) {
  row.places = places;
  return row;
}
consteval Row shown_if(Row row, bool (*is_shown)(const Situation& now)) {
  row.is_shown = is_shown;
  return row;
}

inline constexpr std::array run_rows{
    run_row("grab", keys("g"), "The hands grab the model.", request_of<flow::Request::grab>,
            Buttons::hands, "Grab"),
    run_row("let go", keys("l"), "The hands release the model; the shape stays.",
            request_of<flow::Request::release>, Buttons::hands, "Release"),
    repeating(
        refused_if(run_row("undo", keys("u", "Ctrl Z"),
                           "Undoes the last step, as far back as there is memory (--undo-memory).",
                           request_of<flow::Request::undo>, Buttons::hands, "Undo"),
                   nothing_to_undo)),
    repeating(refused_if(run_row("redo", keys("r", "Ctrl Y", "Ctrl Shift Z"),
                                 "Redoes the step that was undone last.",
                                 request_of<flow::Request::redo>, Buttons::hands, "Redo"),
                         nothing_to_redo)),
    run_row("commit", keys("c"), "Makes the current shape the rest shape.",
            request_of<flow::Request::commit>, Buttons::hands, "Commit"),
    run_row("reset", keys("x"), "Restores the model as it was loaded; undo reverts this.",
            request_of<flow::Request::reset>, Buttons::hands, "Reset"),
    refused_if(run_row("take hold", keys("a"),
                       "The hands grab the model again where they are, without a commit.",
                       request_of<flow::Request::regrab>, Buttons::hands, "Re-grab"),
               without_hold),
    run_row("save", keys("s", "Ctrl S"), "Saves the current model to a new file.",
            simple<flow::SaveShape>, Buttons::hands, "Save"),
    refused_if(run_row("keep", keys("k"),
                       "Saves the most recent input as a recording (--keep-last).",
                       simple<flow::SaveRecording>, Buttons::hands, "Keep"),
               without_kept_input),
    on_if(run_row("take", keys("t"), "Starts or ends a recording to a file.", toggle_recording,
                  Buttons::hands, "Record", "End recording"),
          is_recorded),
    refused_if(shown_if(run_row("mark", keys("."), "Marks this moment in the recording.",
                                simple<flow::Mark>, Buttons::hands, "Mark"),
                        can_mark),
               without_recording),
    refused_if(shown_if(run_row("punch", keys("o"),
                                "Fades the layer that the gloves play in or out (--over, --layer).",
                                simple<flow::Punch>, Buttons::hands, "Punch"),
                        has_layers),
               without_layers),
    on_if(run_row("wire", keys("C"),
                  "Starts drawing a wire between the index fingers, then cuts with it; undo "
                  "reverts this.",
                  draw<flow::Blade::wire>, Buttons::model, "Wire", "Cut"),
          draws),
    on_if(run_row("knife", keys("K"),
                  "Starts drawing a knife from the pointing finger, then cuts with it; undo "
                  "reverts this.",
                  draw<flow::Blade::knife>, Buttons::model, "Knife"),
          draws),
    run_row("join", keys("J"), "Joins overlapping parts into one; undo reverts this.",
            simple<flow::JoinParts>, Buttons::model, "Join"),
    run_row("subdivide", keys("e"),
            "Gives the model about four times as many vertices; undo reverts this.",
            simple<flow::Subdivide>, Buttons::model, "Subdivide"),
    run_row("refine", keys("E"),
            "Adds triangles where the model is stretched, and removes them where it is crowded; "
            "undo reverts this.",
            simple<flow::Refine>, Buttons::model, "Refine"),
    run_row("topology", keys("O"),
            "Separates thin necks, opens thin walls, and fuses surfaces that come close; undo "
            "reverts this.",
            simple<flow::ChangeTopology>, Buttons::model, "Fix thin"),
    refused_if(
        shown_if(run_row("copy part", keys("D"),
                         "Places a copy of the last grabbed part beside it; undo reverts this.",
                         edit_part<false>, Buttons::model, "Copy"),
                 has_parts),
        without_part),
    refused_if(shown_if(run_row("remove part", keys("X"),
                                "Removes the last grabbed part; undo reverts this.",
                                edit_part<true>, Buttons::model, "Remove"),
                        has_parts),
               without_other_part),
    on_if(run_row("symmetry", keys("y"),
                  "Turns symmetry on or off: one hand shapes, or plays, both sides.",
                  toggle_symmetry, Buttons::more, "Symmetry"),
          is_symmetric),
    run_row("mask clear", keys("M"), "Clears the masks, so that everything moves.",
            edit_masks<flow::MaskEdit::clear>, Buttons::more, "Clear masks"),
    run_row("mask invert", keys("Z"),
            "Inverts the masks: protects what was free, and frees what was protected.",
            edit_masks<flow::MaskEdit::invert>, Buttons::more, "Invert masks"),
    on_if(refused_if(
              run_row("clutch left", keys(","),
                      "The left hand releases the puppet, or grabs it again where the hand is.",
                      clutch<Side::left>),
              without_puppet),
          plays<Side::left>),
    on_if(refused_if(
              run_row("clutch right", keys("'"),
                      "The right hand releases the puppet, or grabs it again where the hand is.",
                      clutch<Side::right>),
              without_puppet),
          plays<Side::right>),
    refused_if(run_row("recentre hands", keys("H"),
                       "Moves the hands that trackers move back to where they began.",
                       simple<flow::Recentre>),
               without_trackers),
    run_row("save puppet", keys("S"), "Saves the puppet, or the masks.", simple<flow::SavePuppet>),
    setting_row(flow::setting::mode, "next mode", keys("m"),
                "Chooses the next mode: type 1 (from rest), type 2 (accumulating), clay or parts.",
                choose_next_mode),
    setting_row(flow::setting::kernel, "next kernel", keys("n"),
                "Chooses the next kernel, which shapes a fingertip's influence.",
                choose<&flow::PendingSettings::next_kernel>),
    repeating(setting_row(flow::setting::radius, "smaller radii", keys("["),
                          "Makes the radii smaller.",
                          choose<&flow::PendingSettings::reduce_radii>)),
    repeating(setting_row(flow::setting::radius, "larger radii", keys("]"),
                          "Makes the radii larger.",
                          choose<&flow::PendingSettings::enlarge_radii>)),
    setting_row(flow::setting::brushes, "next brush", keys("w"),
                "Chooses the next brush of type 2 for all fingers.",
                choose<&flow::PendingSettings::next_brush>),
    repeating(setting_row(flow::setting::brush_strength, "weaker brush", keys("-"),
                          "Makes the brushes weaker; below 0 their effect is reversed.",
                          choose<&flow::PendingSettings::weaken>)),
    repeating(setting_row(flow::setting::brush_strength, "stronger brush", keys("="),
                          "Makes the brushes stronger.",
                          choose<&flow::PendingSettings::strengthen>)),
    setting_row(flow::setting::injective, "folding", keys("i"), "Turns fold prevention on or off.",
                choose<&flow::PendingSettings::toggle_folding>),
    setting_row(flow::setting::keep_volume, "more clay", keys(";"),
                "Keeps a quarter more of the volume; after all of it, wraps to 0.",
                choose<&flow::PendingSettings::next_volume>),
    setting_row(flow::setting::hold, "whole hand", keys("j"),
                "Holds the model with whole hands, or only with fingertips, in type 1.",
                choose<&flow::PendingSettings::toggle_hold>),
    setting_row(flow::setting::filter, "filter", keys("A"),
                "Turns smoothing of the joint angles (one-euro) on or off.",
                choose<&flow::PendingSettings::toggle_filter>),
    refused_if(value_row(flow::setting::radius, "set radius", keys("f"),
                         "Sets the radii by moving the pointer sideways, or by typing; a click or "
                         "Enter confirms, Esc cancels."),
               without_radius),
    refused_if(value_row(flow::setting::brush_strength, "set strength", keys("F"),
                         "Sets the strength of brushes in the same way."),
               without_strength),
    shown_at(
        run_row("end run", keys("q"), "Ends the run, and writes the shape.", simple<flow::EndRun>),
        in_terminal | in_window),
    own_row("paint masks", keys("z"),
            "Starts or ends painting masks, which protect vertices, with the mouse; shift erases.",
            in_window | on_page),
    own_row("edit puppet", keys("Tab"), "Edits the puppet with the mouse, or plays it.", in_window),
    own_row("mirror puppet", keys("Y"),
            "While the puppet is edited: turns mirroring to the other side on or off.", in_window),
    own_row("pin point", keys("P"),
            "While the puppet is edited: pins the selected point or position, or unpins it.",
            in_window),
    own_row("delete point", keys("Delete", "Backspace"),
            "Deletes the selected point of the puppet, or all masks while they are painted.",
            in_window),
    own_row("forget place", keys("Esc"),
            "Deselects the position on the puppet, or ends painting masks.", in_window),
    own_row("show hands", keys("h"), "Shows the hands, or hides them.", in_views),
    own_row("show bones", keys("b"), "Shows the bones, or hides them.", in_views),
    own_row("show vectors", keys("v"), "Shows the control vectors, or hides them.", in_views),
    own_row("show radii", keys("d"), "Shows what lies within the radii, or hides it.", in_views),
    own_row("show contact", keys("0"), "Shows where hands touch clay, or hides it.", in_views),
    own_row("show facets", keys("W"), "Switches between flat and smooth shading.", in_views),
    own_row("next material", keys("V"),
            "Chooses the model's next material: lit, or a MatCap of clay, plaster, wax or skin.",
            in_window | in_timeline),
    own_row("view front", keys("1"), "Looks from the front, with Ctrl from the back.", in_views),
    own_row("view right", keys("3"), "Looks from the right, with Ctrl from the left.", in_views),
    own_row("view top", keys("7"), "Looks from the top, with Ctrl from the bottom.", in_views),
    own_row("frame all", keys("Home"), "Shows the whole model.", in_views),
    own_row("fold panel", keys("p"), "Folds or unfolds the panel.", in_window | on_page),
    own_row("search", keys("F3"), "Searches all commands by words.",
            in_window | in_timeline | on_page),
    own_row("list keys", keys("?"), "Lists the keys.", everywhere | in_timeline),
};

} // namespace nendo::commands
