#include "forms/timeline_panel.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

namespace nendo::forms {
namespace {

/// Describes the buttons of a group in one line.
void describe_buttons(Form& form, commands::Buttons group, const TimelineView& view,
                      EditActions& actions) {
  form.lines_of(0);
  for (const commands::Row& row : commands::table())
    if (row.group == group && form.command(row, view.facts))
      actions.commands.push_back(row.edit->command);
}

/// A line with the function's value, and its curve over the whole timeline with the play head.
Drawing drawing_of(const FunctionCurve& function, double head) {
  using Colour = Drawing::Colour;
  constexpr double width = 270.0, height = 24.0, curve_from = 160.0, margin = 2.0;
  Drawing drawing{.width = width, .height = height};
  char value[16];
  std::snprintf(value, sizeof value, " %.2f", function.value);
  drawing.text(0.0, height / 2.0, Colour::ink, function.name + value);
  drawing.rectangle(curve_from, 0.0, width, height, Colour::field);
  const auto& values = function.over_time;
  const bool is_signed = std::ranges::any_of(values, [](float one) { return one < -0.05F; });
  const double least = is_signed ? -1.0 : 0.0;
  const auto at = [&](double share, double one) {
    const double high = (std::clamp(one, least, 1.0) - least) / (1.0 - least);
    return Eigen::Vector2d(curve_from + share * (width - curve_from),
                           height - margin - high * (height - 2.0 * margin))
        .cast<float>()
        .eval();
  };
  std::vector<Eigen::Vector2f> points;
  for (std::size_t point = 0; point < values.size(); ++point)
    points.push_back(at(static_cast<double>(point) / static_cast<double>(values.size() - 1),
                        static_cast<double>(values[point])));
  if (points.size() > 1) drawing.line(std::move(points), Colour::chart);
  const float x = at(head, 0.0).x();
  drawing.line({{x, 0.0F}, {x, static_cast<float>(height)}}, Colour::accent);
  return drawing;
}

void describe_functions(Form& form, const TimelineView& view) {
  const double head = view.duration_s > 0.0 ? view.head_s / view.duration_s : 0.0;
  for (const FunctionCurve& function : view.functions)
    form.drawing("function " + function.name,
                 "The value of " + function.name + " at the play head, and its curve.",
                 drawing_of(function, head));
}

} // namespace

void TimelinePanel::describe(Form& form, const TimelineView& view, EditActions& actions) {
  const std::string name = std::filesystem::path(view.file).filename().string();
  form.text(name + (view.modified ? " *" : "") + "   (? for keys)", Form::Tone::plain,
            "The file to which the timeline is saved.");
  describe_buttons(form, commands::Buttons::file, view, actions);
  if (form.section("Key", "The selected key.", true)) describe_key(form, view, actions);
  if (!view.functions.empty() &&
      form.section("Functions", "What each function of the puppet is at the play head.", true))
    describe_functions(form, view);
  retiming_shown_ = form.section("Timeline", "Changes of the whole timeline.", false);
  if (retiming_shown_) describe_whole(form, view, actions);
  if (view.message.empty()) return;
  form.separator();
  form.text(view.message, view.refused ? Form::Tone::warning : Form::Tone::plain);
}

void TimelinePanel::add(EditCommand command, EditActions& actions) {
  if (command == EditCommand::select_none && sheet_.give_up(actions)) return;
  sheet_.end_drag(actions);
  actions.commands.push_back(command);
}

void TimelinePanel::describe_key(Form& form, const TimelineView& view, EditActions& actions) {
  constexpr const char* help =
      "A key is a pose of a hand at a time; the hand moves from key to key.";
  const bool is_any = view.selected.has_value();
  if (is_any) {
    const StripLane& lane = view.lanes[view.selected->lane];
    char words[96];
    std::snprintf(words, sizeof words, "%s hand, key %zu of %zu, at %.3f s",
                  std::string(name_of(lane.side)).c_str(), view.selected->key, lane.keys_s.size(),
                  lane.keys_s[view.selected->key]);
    form.text(words, Form::Tone::plain, help);
  } else {
    form.text("click a key on the strip to select it", Form::Tone::faint, help);
  }
  describe_buttons(form, commands::Buttons::key, view, actions);
  form.lines_of(1);
  if (is_any &&
      form.number(
          "blend",
          "Blends the key with its neighbours: 1 is the pose that would be there without the key.",
          blend_, 0.0F, 1.0F, "", 2)) {
    blends_ = true;
    actions.tried = KeyBlend{static_cast<double>(blend_)};
  }
  if (blends_ && !(is_any && form.is_changing())) {
    actions.keep = true;
    blends_ = false;
    blend_ = 0.0F;
  }
  if (!is_any || !bends_fingers_) return;
  form.text(view.at_selected ? "drag a ringed fingertip to bend its finger"
                             : "the head is elsewhere: click the key to bend its fingers",
            Form::Tone::faint, "A finger of a key bends to where its tip is dragged.");
}

void TimelinePanel::describe_whole(Form& form, const TimelineView& view, EditActions& actions) {
  describe_buttons(form, commands::Buttons::whole, view, actions);
  form.lines_of(1);
  const auto most = static_cast<float>(view.duration_s);
  if (retiming_.to_s <= retiming_.from_s) retiming_.to_s = view.duration_s;
  const auto time = [&](const char* name, const char* help, double& time_s) {
    auto value = static_cast<float>(time_s);
    if (form.number(name, help, value, 0.0F, most, "s", 3)) time_s = static_cast<double>(value);
  };
  time("from", "Where the part begins that is made longer or shorter.", retiming_.from_s);
  time("to", "Where that part ends.", retiming_.to_s);
  auto scale = static_cast<float>(retiming_.scale);
  if (form.number("times as long", "1 changes nothing.", scale, 0.1F, 10.0F, "", 3))
    retiming_.scale = static_cast<double>(scale);
  form.lines_of(0);
  if (form.button("From head", "The part begins at the play head.")) retiming_.from_s = view.head_s;
  if (form.button("To head", "The part ends at the play head.")) retiming_.to_s = view.head_s;
  if (form.button("Retime", "Makes the part so many times as long.")) actions.retiming = retiming_;
}

void TimelinePanel::describe_strip(Form& form, const TimelineView& view, EditActions& actions) {
  describe_buttons(form, commands::Buttons::head, view, actions);
  bool loops = view.loops;
  const commands::Row& loop = commands::row_of(EditCommand::loop);
  if (form.check("loop", commands::help_of(loop, view.facts), loops))
    actions.commands.push_back(EditCommand::loop);
  auto speed = static_cast<float>(view.speed);
  if (form.number("speed", "How fast the timeline plays (Ctrl Up, Ctrl Down).", speed, 0.1F, 4.0F,
                  "", 2))
    actions.speed = static_cast<double>(speed);
  constexpr const char* made = "After an edit, the shapes of the timeline are made again.";
  char words[64];
  std::snprintf(words, sizeof words, "%.3f s of %.3f s", view.head_s, view.duration_s);
  form.text(words, Form::Tone::plain, "Where the play head is, and the duration of the timeline.");
  if (view.computing) {
    std::snprintf(words, sizeof words, "shapes made to %.2f s", view.computed_s);
    form.text(words, Form::Tone::faint, made);
  } else if (view.shape_is_old) {
    form.text("the shape does not show the last edits", Form::Tone::faint, made);
  }
  const bool is_part = retiming_.from_s > 0.0 || retiming_.to_s < view.duration_s;
  sheet_.describe(form, view, retiming_shown_ && is_part ? std::optional(retiming_) : std::nullopt,
                  actions);
  if (actions.select) { // which keeps the blend
    blends_ = false;
    blend_ = 0.0F;
  }
}

} // namespace nendo::forms
