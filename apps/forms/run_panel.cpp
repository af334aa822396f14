#include "forms/run_panel.hpp"

#include <algorithm>
#include <cstdio>

#include <nendo/base/units.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "forms/run_status.hpp"

namespace nendo::forms {
namespace {

using flow::Request;
constexpr auto plain = Form::Tone::plain;

/// Returns the bends of the joints in degrees, thumb to little finger.
std::vector<float> bends_of(const hand::JointAngles& angles) {
  std::vector<float> bends;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (const hand::Angle angle = hand::angle_at(at); name_of(angle).ends_with("flexion"))
      bends.push_back(static_cast<float>(to_degrees(angles[angle])));
  return bends;
}

void describe_clay(Form& form, const flow::Frame& frame) {
  const flow::ClayState& clay = frame.clay;
  char words[64];
  std::snprintf(words, sizeof words, "touches at %u places, %.3f mm deep", clay.touching,
                clay.penetration_mm);
  form.text(words, plain, "Where hands press the clay, and how deep they were in it.");
  form.text(clay.first_volume > 0.0 ? "volume " + volume_text(frame, clay.volume) + ", at first " +
                                          volume_text(frame, clay.first_volume)
                                    : "volume not kept: no closed surface",
            plain, "The volume of the clay now, and before hands touched it.");
}

void describe_hands(Form& form, const flow::Frame& frame, const DeviceLines& devices) {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const flow::HandFrame& hand = frame.hands[slot];
    if (!hand.present) continue;
    const auto tone = hand.silent || hand.lost ? Form::Tone::warning : plain;
    for (const std::string& line : devices[slot])
      form.text(line, tone, "A device of this hand, and what it sends.");
    form.bends(side, "How far joints are bent: two of the thumb, three of each finger.",
               bends_of(hand.angles));
  }
}

} // namespace

void Strip::add(float value) noexcept {
  std::shift_left(begin(), end(), 1);
  back() = value;
}

void RunPanel::ask(const commands::Row& row, const commands::Situation& now) {
  const commands::Answer answer = commands::press(row, now, pending);
  if (answer.command) commands.push_back(*answer.command);
  note = answer.refusal != nullptr ? answer.refusal : "";
}

void RunPanel::buttons_of(Form& form, commands::Buttons group, const commands::Situation& now) {
  form.lines_of(2);
  for (const commands::Row& row : commands::table()) {
    const bool is_here = row.group == group && (row.places & place_) != 0;
    if (!is_here || (row.is_shown != nullptr && !row.is_shown(now))) continue;
    if (form.command(row, now)) ask(row, now);
  }
}

void RunPanel::box(Form& form, std::string_view name, const commands::Row& row,
                   const commands::Situation& now) {
  const bool is_for_run = row.is_for_run();
  if (!form.box(name, row, now, is_for_run ? row.is_on_in(now) : is_on(row))) return;
  if (is_for_run)
    ask(row, now);
  else
    execute(row);
}

void RunPanel::describe_masks(Form& form, const commands::Situation& now) {
  form.lines_of(2);
  box(form, "symmetry", *commands::named("symmetry"), now);
  if (now.frame.function_count > 0) return; // masks are edited with the puppet
  box(form, "paint masks", *commands::named("paint masks"), now);
  form.lines_of(2);
  for (const char* const name : {"mask clear", "mask invert"})
    if (const commands::Row& row = *commands::named(name); form.command(row, now)) ask(row, now);
  describe_painting(form);
}

void RunPanel::describe_view(Form& form, const commands::Situation& now) {
  constexpr std::string_view show = "show ";
  form.lines_of(1);
  describe_look(form, now);
  form.lines_of(2);
  for (const commands::Row& row : commands::table())
    if ((row.places & place_) != 0 && row.name.starts_with(show))
      box(form, row.name.substr(show.size()), row, now);
}

/// Undoes, or does again, all steps up to the one with that number; 0: also the first of the list.
void RunPanel::go_to_step(const flow::StepList& list, std::size_t at) {
  for (std::size_t step = list.undoable + (list.in_hand ? 1 : 0); step > at; --step)
    commands.emplace_back(Request::undo);
  for (std::size_t step = list.undoable; step < at; ++step)
    commands.emplace_back(Request::redo);
}

void RunPanel::describe_history(Form& form, const flow::Frame& frame) {
  if (!form.section("History", "The steps so far; a click goes to one.", true)) return;
  const flow::StepList& list = frame.steps;
  const std::size_t hidden =
      frame.undo_steps - std::min<std::uint64_t>(frame.undo_steps, list.undoable);
  std::vector<Form::Row> rows{{hidden > 1 ? "earlier" : "the beginning"}};
  for (std::size_t at = 0; at < list.count; ++at) {
    const flow::Step& step = list.steps[at];
    const auto seconds = static_cast<int>(step.at_s);
    char words[48];
    std::snprintf(words, sizeof words, "%d:%02d  %s", seconds / 60, seconds % 60,
                  std::string(name_of(step.kind)).c_str());
    rows.push_back({words, at >= list.undoable});
  }
  if (const auto clicked =
          form.list("step", "Undoes, or does again, all steps up to here.", rows, list.undoable))
    go_to_step(list, *clicked);
}

void RunPanel::describe_timing(Form& form, const flow::Frame& frame) const {
  form.text(std::to_string(frame.commits) + " commits, " + std::to_string(frame.undos) + " undone",
            plain, "How often a shape became the rest shape, and how often that was undone.");
  form.chart("late", "How late ticks began.", late_ms);
  form.chart("uneven", "How much the time between ticks differed from the rate.", uneven_ms);
  form.chart("picture", "How long pictures took.", pictures_ms);
}

void RunPanel::describe(Form& form, const commands::Situation& now, const DeviceLines& devices) {
  const flow::Frame& frame = now.frame;
  // While a puppet is edited, nothing is needed as much as this.
  const bool is_first = edits_puppet();
  if (is_first) describe_puppet(form, frame);
  SettingForm::describe_modes(form, pending.now);
  buttons_of(form, commands::Buttons::hands, now);
  if (form.section("Tool", "The settings that have an effect in this mode.", true)) {
    settings_.describe(form, pending.now);
    describe_masks(form, now);
  }
  if (has_history()) describe_history(form, frame);
  if (form.section("Model", "Changes of the model itself, which undo reverts.", false))
    buttons_of(form, commands::Buttons::model, now);
  if (!is_first) describe_puppet(form, frame);
  if (frame.clay.is_clay && form.section("Contact", "Where the hands touch the clay.", true))
    describe_clay(form, frame);
  if (form.section("View", "What is drawn besides the model.", false)) describe_view(form, now);
  if (form.section("Gloves", "The devices of the hands, and their joints.", false))
    describe_hands(form, frame, devices);
  if (form.section("Timing", "How even the loop and the pictures are.", false))
    describe_timing(form, frame);
}

} // namespace nendo::forms
