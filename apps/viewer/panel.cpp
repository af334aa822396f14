#include "viewer/panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include <nendo/flow/setting.hpp>

#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/puppet_tool.hpp"
#include "viewer/status_bar.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

using flow::Request;

namespace {

constexpr float width_em = 19.0F;
constexpr const char* mouse_words =
    "right drag on a hand moves it, with shift turns it, with the wheel pushes and pulls it;\n"
    "while a puppet is edited, a click places a point, a drag of a point sets where it goes,\n"
    "with shift how it turns, the wheel over one how far it reaches";

/// Returns the bends of the joints in degrees, thumb to little finger.
std::vector<float> bends_of(const hand::JointAngles& angles) {
  std::vector<float> bends;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (const hand::Angle angle = hand::angle_at(at); name_of(angle).ends_with("flexion"))
      bends.push_back(static_cast<float>(to_degrees(angles[angle])));
  return bends;
}

void chart(const char* name, const char* help, const Strip& strip, const char* unit) {
  char words[64];
  const float most = *std::max_element(strip.begin(), strip.end());
  std::snprintf(words, sizeof words, "%s, most %.2f %s", name, static_cast<double>(most), unit);
  ImGui::PushID(name);
  ImGui::PlotLines("##chart", strip.data(), static_cast<int>(strip.size()), 0, words, 0.0F,
                   std::max(1.0F, most), ImVec2(ImGui::GetContentRegionAvail().x, em(3.0F)));
  ImGui::PopID();
  show_text(help);
}

/// Returns whether the window is wide enough for a panel at its right.
bool is_wide() {
  return ImGui::GetIO().DisplaySize.x > em(60.0F);
}

} // namespace

void Strip::add(float value) noexcept {
  std::shift_left(begin(), end(), 1);
  back() = value;
}

void LiveWindow::Panel::follow(const flow::Frame& frame, double rate_hz) {
  if (frame.ticks_run == 0) return;
  const auto ms = [](HostClock::duration time) {
    return static_cast<float>(1e3 * to_seconds(time));
  };
  late_ms.add(std::max(0.0F, ms(frame.woke - frame.scheduled)));
  gap_ms.add(
      static_cast<float>(std::abs(static_cast<double>(ms(frame.since_last)) - 1e3 / rate_hz)));
}

void LiveWindow::Panel::buttons_of(commands::Buttons group, const commands::Situation& now) {
  constexpr int in_line = 2;
  const float width = share_of_line(in_line);
  int column = 0;
  for (const commands::Row& row : commands::table()) {
    if (row.group != group || (row.is_shown != nullptr && !row.is_shown(now))) continue;
    if (column++ % in_line != 0) ImGui::SameLine();
    if (row_button(row, now, width)) ask(row, now);
  }
}

void LiveWindow::Panel::parts() {
  auto material = static_cast<std::size_t>(window.material());
  if (choice_field("material", gl::material_names, material))
    window.material() = static_cast<gl::Material>(material);
  show_help("next material");
  const float left = ImGui::GetCursorPosX();
  const float half = ImGui::GetContentRegionAvail().x / 2.0F;
  std::size_t number = 0;
  for (const auto& [command, is_shown] : window.switches()) {
    if (number++ % 2 != 0) ImGui::SameLine(left + half);
    check(command.substr(std::string_view("show ").size()), *is_shown);
    show_help(command);
  }
}

int LiveWindow::Panel::covered_px() const {
  return folded ? 0 : static_cast<int>(em(gap_em + width_em));
}

void LiveWindow::Panel::follow_settings(const flow::LoopSettings& current) {
  if (pending.follow(current)) settings.follow(pending);
}

/// Undoes, or does again, all steps up to the one with that number; 0: also the first of the list.
void LiveWindow::Panel::go_to_step(const flow::StepList& list, std::size_t at) {
  for (std::size_t step = list.undoable + (list.in_hand ? 1 : 0); step > at; --step)
    commands.emplace_back(Request::undo);
  for (std::size_t step = list.undoable; step < at; ++step)
    commands.emplace_back(Request::redo);
}

void LiveWindow::Panel::history(const flow::Frame& frame) {
  if (!section("History", "The steps so far; a click goes to one.", true)) return;
  const flow::StepList& list = frame.steps;
  const std::size_t hidden =
      frame.undo_steps - std::min<std::uint64_t>(frame.undo_steps, list.undoable);
  ImGui::BeginChild("steps", ImVec2(0.0F, em(7.0F)), true);
  for (std::size_t at = 0; at <= list.count; ++at) {
    char words[48];
    if (at == 0) {
      std::snprintf(words, sizeof words, "%s", hidden > 1 ? "earlier" : "the beginning");
    } else {
      const flow::Step& step = list.steps[at - 1];
      const auto seconds = static_cast<int>(step.at_s);
      std::snprintf(words, sizeof words, "%d:%02d  %s", seconds / 60, seconds % 60,
                    std::string(name_of(step.kind)).c_str());
    }
    ImGui::PushID(static_cast<int>(at));
    const bool is_undone = at > list.undoable;
    if (is_undone)
      ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    const bool is_present = at == list.undoable;
    if (ImGui::Selectable(words, is_present)) go_to_step(list, at);
    note_control("step " + std::to_string(at), words);
    show_text("Undoes, or does again, all steps up to here.");
    if (is_present && std::exchange(history_shown, list.version) != list.version)
      ImGui::SetScrollHereY(0.5F);
    if (is_undone) ImGui::PopStyleColor();
    ImGui::PopID();
  }
  ImGui::EndChild();
}

void LiveWindow::Panel::clay(const flow::Frame& frame) {
  const flow::ClayState& clay = frame.clay;
  ImGui::Text("touches at %u places, %.3f mm deep", clay.touching, clay.penetration_mm);
  if (!(clay.first_volume > 0.0)) {
    ImGui::TextWrapped("volume not kept: no closed surface");
    return;
  }
  ImGui::Text("volume %s, at first %s", volume_text(frame, clay.volume).c_str(),
              volume_text(frame, clay.first_volume).c_str());
}

void LiveWindow::Panel::timing(const flow::Frame& frame) const {
  ImGui::TextWrapped(
      "%llu ticks, %llu commits, %llu undone", static_cast<unsigned long long>(frame.ticks_run),
      static_cast<unsigned long long>(frame.commits), static_cast<unsigned long long>(frame.undos));
  chart("late", "How late ticks began.", late_ms, "ms");
  chart("uneven", "How much the time between ticks differed from the rate.", gap_ms, "ms");
  chart("picture", "How long pictures of this window took.", pictures_ms, "ms");
}

void LiveWindow::Panel::hands(const flow::Frame& frame, const Gauges& gauges) {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    ImGui::PushTextWrapPos(0.0F);
    for (const std::string& line : gauges.devices[slot])
      ImGui::TextUnformatted(line.c_str());
    ImGui::PopTextWrapPos();
    const auto bends = bends_of(hand.angles);
    ImGui::PushID(static_cast<int>(slot));
    ImGui::PlotHistogram("##joints", bends.data(), static_cast<int>(bends.size()), 0,
                         "thumb to little, degrees", 0.0F, 110.0F,
                         ImVec2(ImGui::GetContentRegionAvail().x, em(3.4F)));
    ImGui::PopID();
    show_text("How far joints are bent: two of the thumb, three of each finger.");
  }
}

void LiveWindow::Panel::sections(const flow::Frame& frame, const Gauges& gauges) {
  const commands::Situation now{frame, gauges.facts};
  const auto draw_puppet = [&] {
    if (section("Puppet", "What each finger moves, as points on the model.", true)) puppet(frame);
  };
  // While a puppet is edited, nothing is needed as much as this.
  const bool edits = editor.edits_puppet();
  if (edits) draw_puppet();
  SettingControls::draw_modes(pending.now);
  buttons_of(commands::Buttons::hands, now);
  if (section("Tool", "The settings that have an effect in this mode.", true)) {
    settings.draw(pending.now);
    masks(now);
  }
  if (!is_wide()) history(frame);
  if (section("Model", "Changes of the model itself, which undo reverts.", false))
    buttons_of(commands::Buttons::model, now);
  if (!edits) draw_puppet();
  if (frame.clay.is_clay && section("Contact", "Where the hands touch the clay.", true))
    clay(frame);
  if (section("View", "What is drawn besides the model.", false)) parts();
  if (section("Gloves", "The devices of the hands, and their joints.", false)) hands(frame, gauges);
  if (section("Timing", "How even the loop and the pictures are.", false)) timing(frame);
}

void LiveWindow::Panel::draw_tools(const flow::Frame& frame, const Gauges& gauges, float top) {
  const float gap = em(gap_em);
  const float high = ImGui::GetIO().DisplaySize.y - status_bar_height() - gap - top;
  if (std::exchange(fold_asked, false)) ImGui::SetNextWindowCollapsed(!folded);
  // Without navigation, or Tab, which begins to edit a puppet, would also begin to edit a number.
  const std::string title = gauges.model + "###panel";
  const bool open =
      begin_pane(title.c_str(), {gap, top}, {0.0F, 0.0F}, {em(width_em), std::max(em(3.0F), high)},
                 ImGuiWindowFlags_NoNavInputs);
  folded = ImGui::IsWindowCollapsed();
  if (open) sections(frame, gauges);
  ImGui::End();
}

/// At the window's right, where tools of any length leave it in sight.
void LiveWindow::Panel::draw_history(const flow::Frame& frame, float top) {
  begin_pane("history", {ImGui::GetIO().DisplaySize.x - em(gap_em), top}, {1.0F, 0.0F},
             {em(12.0F), em(20.0F)}, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoNav);
  history(frame);
  ImGui::End();
}

/// Over the picture, for the first minutes.
void LiveWindow::Panel::draw_hints() {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float middle = (static_cast<float>(covered_px()) + all.x) / 2.0F;
  const float bottom = all.y - status_bar_height() - em(gap_em);
  begin_pane("hints", {middle, bottom}, {0.5F, 1.0F}, {0.0F, 0.0F},
             ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoNav);
  for (const auto& [keys, text] : commands::hints) {
    ImGui::TextColored(accent(), "%s", keys.data());
    ImGui::SameLine(em(4.0F));
    ImGui::TextUnformatted(text.data());
  }
  ImGui::TextDisabled("F3 finds any command, ? lists the keys.");
  ImGui::SameLine();
  if (button("Do not show again")) hints = false;
  show_text("Closes these hints for good.");
  ImGui::End();
}

void LiveWindow::Panel::draw(const flow::Frame& frame, const Gauges& gauges) {
  const float top = em(gap_em) + window.above_px();
  draw_tools(frame, gauges, top);
  if (!folded && is_wide()) draw_history(frame, top);
  if (!commands.empty()) note.clear();
  const commands::Situation now{frame, gauges.facts};
  if (gesture.is_on()) {
    gesture.follow(); // which takes all keys
  } else {
    window.follow_view_keys();
    for (const commands::Row* const row : search.asked(commands::in_window, now, mouse_words))
      take(*row, now);
  }
  message = gesture.is_on() ? gesture.message() : note.empty() ? gauges.report : note;
  const bool is_error = !note.empty() || gauges.report_is_error;
  draw_status_bar(frame, gauges, message, is_error && !gesture.is_on());
  if (hints) draw_hints();
  if (const auto change = pending.ask()) commands.push_back(*change);
}

void LiveWindow::Panel::take(const commands::Row& row, const commands::Situation& now) {
  if (row.is_for_run())
    ask(row, now);
  else if (!row.setting.empty())
    begin_gesture(row, now);
  else
    execute(row.name);
}

void LiveWindow::Panel::ask(const commands::Row& row, const commands::Situation& now) {
  const commands::Answer answer = commands::press(row, now, pending);
  if (answer.command) commands.push_back(*answer.command);
  note = answer.refusal != nullptr ? answer.refusal : "";
}

/// Returns the metres of a pixel at the model under the mouse or, beside it, at what the camera
/// looks at.
double LiveWindow::Panel::metres_of_pixel(const flow::Frame& frame) const {
  const ModelPicture picture(window, frame.units_per_metre);
  const deform::Points& rest = editor.model().vertices;
  deform::Mesh shape = editor.seen();
  if (!editor.is_on() && rest.cols() > 0) {
    const deform::BlockLayout layout(rest);
    if (frame.shape.block_count() == layout.block_count())
      layout.unpack(frame.shape, shape.vertices);
  }
  const auto hit = picture.hit_of_mouse(shape, rest);
  const Eigen::Vector3d place = hit ? hit->at : picture.camera.target;
  return way_in_picture(picture.camera, place, 1.0, 0.0, picture.size.height).norm() /
         frame.units_per_metre;
}

void LiveWindow::Panel::begin_gesture(const commands::Row& row, const commands::Situation& now) {
  using flow::setting::brush_strength;
  const bool is_radius = row.setting == flow::setting::radius.name;
  const bool is_editor = is_radius && editor.is_on(); // of its brush or of its points
  const char* const refusal = is_editor ? nullptr : row.refusal_in(now);
  note = refusal != nullptr ? refusal : "";
  if (refusal != nullptr) return;
  if (!is_radius) {
    gesture.begin({std::string(brush_strength.label), "", pending.now.brush_strength,
                   brush_strength.range, 2},
                  [this](double strength) { pending.now.brush_strength = strength; });
    return;
  }
  const double cm_of_pixel = 100.0 * metres_of_pixel(now.frame);
  const auto begin = [&](double first_cm, const flow::Range& range, auto use) {
    gesture.begin({"radius", "cm", first_cm, range, 1, cm_of_pixel},
                  [first_cm, use](double cm) { use(cm / first_cm); });
  };
  if (is_editor) {
    const double radius = editor.brushes() ? editor.brush_radius() : editor.radius();
    begin(100.0 * radius / now.frame.units_per_metre, {0.1, 1000.0},
          [this](double factor) { editor.multiply_radius(factor); });
    return;
  }
  const auto& radii_m = pending.now.radius_m; // all keep their ratios to the largest
  const flow::Range& handy_m = flow::setting::radius.handy;
  begin(100.0 * *std::max_element(radii_m.begin(), radii_m.end()),
        {100.0 * handy_m.min, 100.0 * handy_m.max}, [this, radii_m](double factor) {
          for (std::size_t finger = 0; finger < radii_m.size(); ++finger)
            pending.now.radius_m[finger] =
                flow::setting::radius.range.nearest(factor * radii_m[finger]);
        });
}

/// Executes a command that concerns the window alone.
void LiveWindow::Panel::execute(std::string_view name) {
  window.execute(name);
  if (name == "fold panel") fold_asked = true;
  if (name == "edit puppet") editor.turn(!editor.is_on());
  if (name == "paint masks") editor.toggle_brush();
  if (!editor.is_on()) return;
  if (editor.brushes() && !editor.rig().puppet().is_played()) {
    if (name == "forget place") editor.toggle_brush();
    if (name == "delete point") commands.emplace_back(flow::SetMask{flow::MaskEdit::clear});
    return;
  }
  if (name == "mirror puppet") editor.toggle_mirror();
  if (name == "pin point") editor.toggle_pin();
  if (name == "delete point") editor.remove_point();
  if (name == "forget place") editor.forget_place();
}

} // namespace nendo::viewer
