#include "session/run_keys.hpp"

#include <algorithm>
#include <iostream>

#include <spdlog/fmt/fmt.h>

#include "cli/cli.hpp"

namespace nendo::session {

namespace {

std::string brush_words(const flow::LoopSettings& settings) {
  const auto& brushes = settings.brushes;
  if (settings.mode != flow::Mode::type2 ||
      std::all_of(brushes.begin(), brushes.end(),
                  [](deform::Brush one) { return one == deform::Brush::pull; }))
    return {};
  return fmt::format(", {} at strength {:g}", flow::in_words(brushes), settings.brush_strength);
}

} // namespace

RunKeys::RunKeys(std::chrono::milliseconds timeout, bool keeps_last_minute) : timeout_(timeout) {
  if (!keys_.are_available()) return;
  cli::note(
      "keys: g lets go, takes hold again; a takes hold anew; c keeps the shape so far; u undoes, r "
      "redoes, x "
      "resets; " +
      std::string("[ and ] make the radii smaller, larger; m the next mode, n the next kernel, ") +
      "w the next brush of type 2, - and = make it weaker, stronger; i never folds, or may; "
      "semicolon more clay, from all to air; j the whole hand holds, or its tips; e "
      "makes the model finer, E makes its triangles suit the shape; O lets what is thin part, open "
      "or fuse; C begins to draw a wire, K a "
      "knife, and cuts by it; J joins parts that "
      "overlap; D copies the part that was taken last, X removes it; t records; . marks the "
      "moment; "
      "o punches a layer in or out; s saves; "
      "comma and quote let one hand go of a puppet; y shapes both sides by one hand; z clears the "
      "masks, "
      "Z turns them round; " +
      (keeps_last_minute ? "k keeps the recording of what was just done; " : "") + "q ends");
}

void RunKeys::update(const RunStatus& status, flow::CommandRing& commands) {
  const auto key = keys_.next(timeout_);
  if (!key) return;
  const bool held = status.frame.held;
  if (*key == 'g') commands.try_push(held ? flow::Request::let_go : flow::Request::grab);
  if (*key == 'c' || *key == ' ') commands.try_push(flow::Request::commit);
  if (*key == 'a') commands.try_push(flow::Request::take_hold);
  if (*key == 'u') step(flow::Request::undo, status.frame.undo_steps, commands);
  if (*key == 'r' || *key == 'U') step(flow::Request::redo, status.frame.redo_steps, commands);
  if (*key == 'x') commands.try_push(flow::Request::reset);
  if (*key == 't') commands.try_push(flow::SetRecording{!status.recording});
  if (*key == 'e') commands.try_push(flow::Subdivide{});
  if (*key == 'E') commands.try_push(flow::Refine{});
  if (*key == 'O') commands.try_push(flow::ChangeTopology{});
  if (*key == 'C') commands.try_push(flow::DrawWire{!status.frame.wire.is_drawn()});
  if (*key == 'K')
    commands.try_push(flow::DrawWire{!status.frame.wire.is_drawn(), flow::Blade::knife});
  if (*key == 'J') commands.try_push(flow::JoinParts{});
  if (*key == 'D') commands.try_push(flow::EditPart{});
  if (*key == 'X') commands.try_push(flow::EditPart{true});
  if (*key == '.') commands.try_push(flow::Mark{});
  if (*key == 'o') commands.try_push(flow::Punch{});
  if (*key == ',') clutch(Side::left, status.frame, commands);
  if (*key == '\'') clutch(Side::right, status.frame, commands);
  if (*key == 'y') commands.try_push(flow::SetSymmetry{!status.frame.symmetric});
  if (*key == 'z') commands.try_push(flow::SetMask{flow::MaskEdit::clear});
  if (*key == 'Z') commands.try_push(flow::SetMask{flow::MaskEdit::invert});
  if (*key == 's') commands.try_push(flow::SaveShape{});
  if (*key == 'k') commands.try_push(flow::SaveRecording{});
  if (*key == 'q') commands.try_push(flow::EndRun{});
  change(*key, status.frame, commands);
}

void RunKeys::change(char key, const flow::Frame& frame, flow::CommandRing& commands) {
  wanted_.follow(frame.settings);
  if (key == '[') wanted_.reduce_radii();
  if (key == ']') wanted_.enlarge_radii();
  if (key == 'm') wanted_.next_mode(frame.function_count > 0);
  if (key == 'n') wanted_.next_kernel();
  if (key == 'i') wanted_.toggle_folding();
  if (key == 'w') wanted_.next_brush();
  if (key == ';') wanted_.next_volume();
  if (key == 'j') wanted_.toggle_hold();
  if (key == '-') wanted_.weaken();
  if (key == '=') wanted_.strengthen();
  const auto command = wanted_.ask();
  if (!command) return;
  commands.try_push(*command);
  const auto [least, most] =
      std::minmax_element(wanted_.now.radius_m.begin(), wanted_.now.radius_m.end());
  report(fmt::format(
      "{}{}{}, {}, {}, radius {:.1f}{} cm", name_of(wanted_.now.mode),
      wanted_.now.hold == flow::Hold::hand ? ", whole hand" : "", brush_words(wanted_.now),
      deform::name_of(wanted_.now.kernel),
      wanted_.now.keep_volume > 0.0 ? fmt::format("{:g} of clay", wanted_.now.keep_volume)
      : wanted_.now.injective       ? "never folds"
                                    : "may fold",
      100.0 * *least, *least == *most ? std::string() : fmt::format(" to {:.1f}", 100.0 * *most)));
}

// The loop is asked in any case, because it may be a few ticks ahead of `steps`.
void RunKeys::step(flow::Request request, std::uint64_t steps, flow::CommandRing& commands) {
  commands.try_push(request);
  if (steps == 0)
    report(request == flow::Request::undo ? "there is nothing to undo"
                                          : "there is nothing to redo");
}

void RunKeys::clutch(Side side, const flow::Frame& frame, flow::CommandRing& commands) {
  const bool holds = frame.let_go[flow::Placement::index_of(side)];
  commands.try_push(flow::SetClutch{side, puppet::RigPlayer::all_fingers, holds});
}

void RunKeys::report(const std::string& message) {
  std::cerr << '\n'; // so that a line of progress stays as it is
  cli::note(message);
}

} // namespace nendo::session
