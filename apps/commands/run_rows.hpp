#pragma once
// The rows of the table of commands for a run.

#include <array>

#include "commands/commands.hpp"
#include "commands/edit_rows.hpp"

namespace nendo::commands {

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
  return !now.frame.let_go[flow::Placement::index_of(side)];
}
template <void (flow::WantedSettings::*change)() noexcept>
void choose(flow::WantedSettings& wanted, const flow::Frame&) {
  (wanted.*change)();
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
inline const char* without_part(const Situation& now) {
  return now.frame.parts.chosen == deform::no_index ? no_part : nullptr;
}

inline constexpr std::array run_rows{
    Row{.name = "grab",
        .keys = keys("g"),
        .help = "The hands grab the model.",
        .button = "Grab",
        .group = Buttons::hands,
        .make = request_of<flow::Request::grab>},
    Row{.name = "let go",
        .keys = keys("l"),
        .help = "The hands release the model; the shape stays.",
        .button = "Release",
        .group = Buttons::hands,
        .make = request_of<flow::Request::let_go>},
    Row{.name = "undo",
        .keys = keys("u", "Ctrl Z"),
        .help = "Undoes the last step, as far back as there is memory (--undo-memory).",
        .button = "Undo",
        .group = Buttons::hands,
        .repeats = true,
        .make = request_of<flow::Request::undo>,
        .refusal = [](const Situation& now) -> const char* {
          return now.frame.undo_steps == 0 ? "There is nothing to undo." : nullptr;
        }},
    Row{.name = "redo",
        .keys = keys("r", "Ctrl Y", "Ctrl Shift Z"),
        .help = "Redoes the step that was undone last.",
        .button = "Redo",
        .group = Buttons::hands,
        .repeats = true,
        .make = request_of<flow::Request::redo>,
        .refusal = [](const Situation& now) -> const char* {
          return now.frame.redo_steps == 0 ? "There is nothing to redo." : nullptr;
        }},
    Row{.name = "commit",
        .keys = keys("c"),
        .help = "Makes the current shape the rest shape.",
        .button = "Commit",
        .group = Buttons::hands,
        .make = request_of<flow::Request::commit>},
    Row{.name = "reset",
        .keys = keys("x"),
        .help = "Restores the model as it was loaded; undo reverts this.",
        .button = "Reset",
        .group = Buttons::hands,
        .make = request_of<flow::Request::reset>},
    Row{.name = "take hold",
        .keys = keys("a"),
        .help = "The hands grab the model again where they are, without a commit.",
        .button = "Re-grab",
        .group = Buttons::hands,
        .make = request_of<flow::Request::take_hold>,
        .refusal = [](const Situation& now) -> const char* {
          return now.frame.held ? nullptr : "The hands do not hold the model.";
        }},
    Row{.name = "save",
        .keys = keys("s", "Ctrl S"),
        .help = "Saves the current model to a new file.",
        .button = "Save",
        .group = Buttons::hands,
        .make = simple<flow::SaveShape>},
    Row{.name = "keep",
        .keys = keys("k"),
        .help = "Saves the most recent input as a recording (--keep-last).",
        .button = "Keep",
        .group = Buttons::hands,
        .make = simple<flow::SaveRecording>,
        .refusal = [](const Situation& now) -> const char* {
          return now.facts.keeps_last ? nullptr : nothing_kept;
        }},
    Row{.name = "take",
        .keys = keys("t"),
        .help = "Starts or ends a recording to a file.",
        .button = "Record",
        .button_on = "End recording",
        .group = Buttons::hands,
        .make = [](bool on) -> flow::Command { return flow::SetRecording{!on}; },
        .is_on = [](const Situation& now) { return now.facts.recorded; }},
    Row{.name = "mark",
        .keys = keys("."),
        .help = "Marks this moment in the recording.",
        .button = "Mark",
        .group = Buttons::hands,
        .make = simple<flow::Mark>,
        .refusal = [](const Situation& now) -> const char* {
          return now.facts.can_mark ? nullptr : no_recording;
        },
        .is_shown = [](const Situation& now) { return now.facts.can_mark; }},
    Row{.name = "punch",
        .keys = keys("o"),
        .help = "Fades the layer that the gloves play in or out (--over, --layer).",
        .button = "Punch",
        .group = Buttons::hands,
        .make = simple<flow::Punch>,
        .refusal = [](const Situation& now) -> const char* {
          return now.facts.has_layers ? nullptr : no_layers;
        },
        .is_shown = [](const Situation& now) { return now.facts.has_layers; }},
    Row{.name = "wire",
        .keys = keys("C"),
        .help = "Starts drawing a wire between the index fingers, then cuts with it; undo reverts "
                "this.",
        .button = "Wire",
        .button_on = "Cut",
        .group = Buttons::model,
        .make = draw<flow::Blade::wire>,
        .is_on = draws},
    Row{.name = "knife",
        .keys = keys("K"),
        .help = "Starts drawing a knife from the pointing finger, then cuts with it; undo reverts "
                "this.",
        .button = "Knife",
        .group = Buttons::model,
        .make = draw<flow::Blade::knife>,
        .is_on = draws},
    Row{.name = "join",
        .keys = keys("J"),
        .help = "Joins overlapping parts into one; undo reverts this.",
        .button = "Join",
        .group = Buttons::model,
        .make = simple<flow::JoinParts>},
    Row{.name = "subdivide",
        .keys = keys("e"),
        .help = "Gives the model about four times as many vertices; undo reverts this.",
        .button = "Subdivide",
        .group = Buttons::model,
        .make = simple<flow::Subdivide>},
    Row{.name = "refine",
        .keys = keys("E"),
        .help = "Adds triangles where the model is stretched, and removes them where it is "
                "crowded; undo reverts this.",
        .button = "Refine",
        .group = Buttons::model,
        .make = simple<flow::Refine>},
    Row{.name = "topology",
        .keys = keys("O"),
        .help = "Separates thin necks, opens thin walls, and fuses surfaces that come close; undo "
                "reverts this.",
        .button = "Fix thin spots",
        .group = Buttons::model,
        .make = simple<flow::ChangeTopology>},
    Row{.name = "copy part",
        .keys = keys("D"),
        .help = "Places a copy of the last grabbed part beside it; undo reverts this.",
        .button = "Copy",
        .group = Buttons::model,
        .make = edit_part<false>,
        .refusal = without_part,
        .is_shown = has_parts},
    Row{.name = "remove part",
        .keys = keys("X"),
        .help = "Removes the last grabbed part; undo reverts this.",
        .button = "Remove",
        .group = Buttons::model,
        .make = edit_part<true>,
        .refusal = [](const Situation& now) -> const char* {
          if (const char* const none = without_part(now)) return none;
          return now.frame.parts.count > 1 ? nullptr : "The model has no other part.";
        },
        .is_shown = has_parts},
    Row{.name = "symmetry",
        .keys = keys("y"),
        .help = "Turns symmetry on or off: one hand shapes, or plays, both sides.",
        .button = "Symmetry",
        .group = Buttons::more,
        .make = [](bool on) -> flow::Command { return flow::SetSymmetry{!on}; },
        .is_on = [](const Situation& now) { return now.frame.symmetric; }},
    Row{.name = "mask clear",
        .keys = keys("M"),
        .help = "Clears the masks, so that everything moves.",
        .button = "Clear masks",
        .group = Buttons::more,
        .make = edit_masks<flow::MaskEdit::clear>},
    Row{.name = "mask invert",
        .keys = keys("Z"),
        .help = "Inverts the masks: protects what was free, and frees what was protected.",
        .button = "Invert masks",
        .group = Buttons::more,
        .make = edit_masks<flow::MaskEdit::invert>},
    Row{.name = "clutch left",
        .keys = keys(","),
        .help = "The left hand releases the puppet, or grabs it again where the hand is.",
        .make = clutch<Side::left>,
        .is_on = plays<Side::left>,
        .refusal = without_puppet},
    Row{.name = "clutch right",
        .keys = keys("'"),
        .help = "The right hand releases the puppet, or grabs it again where the hand is.",
        .make = clutch<Side::right>,
        .is_on = plays<Side::right>,
        .refusal = without_puppet},
    Row{.name = "save puppet",
        .keys = keys("S"),
        .help = "Saves the puppet, or the masks.",
        .make = simple<flow::SavePuppet>},
    Row{.name = "next mode",
        .keys = keys("m"),
        .help = "Chooses the next mode: type 1 (from rest), type 2 (accumulating), clay or parts.",
        .choose = [](flow::WantedSettings& wanted,
                     const flow::Frame& frame) { wanted.next_mode(frame.function_count > 0); }},
    Row{.name = "next kernel",
        .keys = keys("n"),
        .help = "Chooses the next kernel, which shapes a fingertip's influence.",
        .choose = choose<&flow::WantedSettings::next_kernel>},
    Row{.name = "smaller radii",
        .keys = keys("["),
        .help = "Makes the radii smaller.",
        .repeats = true,
        .choose = choose<&flow::WantedSettings::reduce_radii>},
    Row{.name = "larger radii",
        .keys = keys("]"),
        .help = "Makes the radii larger.",
        .repeats = true,
        .choose = choose<&flow::WantedSettings::enlarge_radii>},
    Row{.name = "next brush",
        .keys = keys("w"),
        .help = "Chooses the next brush of type 2 for all fingers.",
        .choose = choose<&flow::WantedSettings::next_brush>},
    Row{.name = "weaker brush",
        .keys = keys("-"),
        .help = "Makes the brushes weaker; below 0 their effect is reversed.",
        .repeats = true,
        .choose = choose<&flow::WantedSettings::weaken>},
    Row{.name = "stronger brush",
        .keys = keys("="),
        .help = "Makes the brushes stronger.",
        .repeats = true,
        .choose = choose<&flow::WantedSettings::strengthen>},
    Row{.name = "folding",
        .keys = keys("i"),
        .help = "Turns fold prevention on or off.",
        .choose = choose<&flow::WantedSettings::toggle_folding>},
    Row{.name = "more clay",
        .keys = keys(";"),
        .help = "Keeps a quarter more of the volume; after all of it, wraps to 0.",
        .choose = choose<&flow::WantedSettings::next_volume>},
    Row{.name = "whole hand",
        .keys = keys("j"),
        .help = "Holds the model with whole hands, or only with fingertips, in type 1.",
        .choose = choose<&flow::WantedSettings::toggle_hold>},
    Row{.name = "filter",
        .keys = keys("F"),
        .help = "Turns smoothing of the joint angles (one-euro) on or off.",
        .choose = choose<&flow::WantedSettings::toggle_filter>},
    Row{.name = "end run",
        .keys = keys("q"),
        .help = "Ends the run, and writes the shape.",
        .places = in_terminal | in_window,
        .make = simple<flow::EndRun>},
    Row{.name = "paint masks",
        .keys = keys("z"),
        .help = "Starts or ends painting masks, which protect vertices, with the mouse.",
        .places = in_window},
    Row{.name = "edit puppet",
        .keys = keys("Tab"),
        .help = "Edits the puppet with the mouse, or plays it.",
        .places = in_window},
    Row{.name = "mirror puppet",
        .keys = keys("Y"),
        .help = "While the puppet is edited: turns mirroring to the other side on or off.",
        .places = in_window},
    Row{.name = "pin point",
        .keys = keys("P"),
        .help = "While the puppet is edited: pins the selected point or position, or unpins it.",
        .places = in_window},
    Row{.name = "delete point",
        .keys = keys("Delete", "Backspace"),
        .help = "Deletes the selected point of the puppet, or all masks while they are painted.",
        .places = in_window},
    Row{.name = "forget place",
        .keys = keys("Esc"),
        .help = "Deselects the position on the puppet, or ends painting masks.",
        .places = in_window},
    Row{.name = "show hands",
        .keys = keys("h"),
        .help = "Shows the hands, or hides them.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "show bones",
        .keys = keys("b"),
        .help = "Shows the bones, or hides them.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "show vectors",
        .keys = keys("v"),
        .help = "Shows the control vectors, or hides them.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "show radii",
        .keys = keys("d"),
        .help = "Shows the radii, or hides them.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "show contact",
        .keys = keys("0"),
        .help = "Shows where hands touch clay, or hides it.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "show facets",
        .keys = keys("f"),
        .help = "Switches between flat and smooth shading.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "view front",
        .keys = keys("1"),
        .help = "Looks from the front, with Ctrl from the back.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "view right",
        .keys = keys("3"),
        .help = "Looks from the right, with Ctrl from the left.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "view top",
        .keys = keys("7"),
        .help = "Looks from the top, with Ctrl from the bottom.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "frame all",
        .keys = keys("Home"),
        .help = "Shows the whole model.",
        .places = in_window | on_page | in_timeline},
    Row{.name = "fold panel",
        .keys = keys("p"),
        .help = "Folds or unfolds the panel.",
        .places = in_window | on_page},
    Row{.name = "list keys",
        .keys = keys("?"),
        .help = "Lists the keys.",
        .places = everywhere | in_timeline},
};

} // namespace nendo::commands
