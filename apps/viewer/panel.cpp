#include "viewer/panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <nendo/flow/setting.hpp>

#include "viewer/command_widgets.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

using flow::Request;
using Pending = flow::PendingSettings;
using hand::Joint;

namespace {

constexpr std::array finger_names{"thumb", "index", "middle", "ring", "little"};
constexpr float label_width = 58.0F; // of "strength" and of fingers, beside what they name

const char* kernel_words(deform::Wendland kernel) {
  constexpr std::array words{"Wendland C0", "Wendland C2", "Wendland C4", "Wendland C6"};
  const auto* const first = Pending::kernels.begin();
  return words[static_cast<std::size_t>(std::find(first, Pending::kernels.end(), kernel) - first)];
}

// How far two joints that follow each other are turned, degrees.
float bend_deg(const hand::HandPose& pose, Joint from, Joint to) {
  const Eigen::Matrix3d turn = pose[from].linear().transpose() * pose[to].linear();
  const double cosine = std::clamp((turn.trace() - 1.0) / 2.0, -1.0, 1.0);
  return static_cast<float>(to_degrees(std::acos(cosine)));
}

// Three joints a finger, from its root.
std::array<float, 15> bends_of(const hand::HandPose& pose) {
  std::array<float, 15> bends{};
  bends[0] = bend_deg(pose, Joint::wrist, Joint::thumb_metacarpal);
  bends[1] = bend_deg(pose, Joint::thumb_metacarpal, Joint::thumb_proximal);
  bends[2] = bend_deg(pose, Joint::thumb_proximal, Joint::thumb_distal);
  for (std::size_t finger = 1; finger < 5; ++finger) {
    const std::size_t metacarpal = index_of(Joint::index_metacarpal) + 5 * (finger - 1);
    for (std::size_t joint = 0; joint < 3; ++joint)
      bends[3 * finger + joint] = bend_deg(pose, static_cast<Joint>(metacarpal + joint),
                                           static_cast<Joint>(metacarpal + joint + 1));
  }
  return bends;
}

/// Chooses so many values in 1, as `format` shows them.
void slider(const flow::NumberSetting& number, flow::LoopSettings& chosen, double steps,
            const char* format) {
  auto value = static_cast<float>(number.of(chosen));
  if (ImGui::SliderFloat(number.label.data(), &value, static_cast<float>(number.range.min),
                         static_cast<float>(number.range.max), format))
    number.of(chosen) =
        number.range.nearest(std::round(steps * static_cast<double>(value)) / steps);
}

void chart(const char* name, const Strip& strip, const char* unit) {
  char words[64];
  std::snprintf(words, sizeof words, "%s, most %.2f %s", name, static_cast<double>(strip.most()),
                unit);
  ImGui::PushID(name);
  ImGui::PlotLines("##chart", strip.data(), strip.size(), strip.oldest(), words, 0.0F,
                   std::max(1.0F, strip.most()), ImVec2(ImGui::GetContentRegionAvail().x, 44.0F));
  ImGui::PopID();
}

/// Undoes, or does again, all steps up to the one with that number; 0: also the first of the list.
void go_to_step(const flow::StepList& list, std::size_t at, Commands& commands) {
  for (std::size_t step = list.undoable + (list.in_hand ? 1 : 0); step > at; --step)
    commands.emplace_back(Request::undo);
  for (std::size_t step = list.undoable; step < at; ++step)
    commands.emplace_back(Request::redo);
}

} // namespace

float Strip::most() const noexcept {
  return *std::max_element(values_.begin(), values_.end());
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

void LiveWindow::Panel::buttons(const commands::Situation& now, const Gauges& gauges,
                                Commands& commands) {
  ImGui::TextUnformatted(now.frame.held ? "The hands hold the model." : "The hands hold nothing.");
  buttons_of(commands::Buttons::hands, 2, now, commands);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(1.0F, ImGui::GetStyle().FramePadding.y));
  buttons_of(commands::Buttons::model, 3, now, commands);
  ImGui::PopStyleVar();
  message = note.empty() ? gauges.report : note;
  if (!message.empty()) ImGui::TextWrapped("%s", message.c_str());
}

void LiveWindow::Panel::buttons_of(commands::Buttons group, int in_line,
                                   const commands::Situation& now, Commands& commands) {
  const float space = ImGui::GetStyle().ItemSpacing.x;
  const auto count = static_cast<float>(in_line);
  const float width = (ImGui::GetContentRegionAvail().x - (count - 1.0F) * space) / count;
  int column = 0;
  for (const commands::Row& row : commands::table()) {
    if (row.group != group || (row.is_shown != nullptr && !row.is_shown(now))) continue;
    if (column++ % in_line != 0) ImGui::SameLine();
    if (row_button(row, now, width)) ask(row, now, commands);
  }
}

void LiveWindow::Panel::parts(SceneWindow& window) {
  render::SceneParts& shown = window.parts();
  const std::array boxes{
      std::pair{"hands", &shown.hands},      std::pair{"bones", &shown.bones},
      std::pair{"vectors", &shown.vectors},  std::pair{"radii", &shown.radii},
      std::pair{"contact", &shown.contacts}, std::pair{"facets", &window.facets()}};
  constexpr std::size_t boxes_per_line = 3;
  const float width = ImGui::GetContentRegionAvail().x / boxes_per_line;
  for (std::size_t at = 0; at < boxes.size(); ++at) {
    if (at % boxes_per_line != 0)
      ImGui::SameLine(ImGui::GetStyle().WindowPadding.x +
                      width * static_cast<float>(at % boxes_per_line));
    ImGui::Checkbox(boxes[at].first, boxes[at].second);
  }
}

void LiveWindow::Panel::follow_settings(const flow::LoopSettings& current) {
  if (!pending.follow(current)) return;
  if (!pending.has_one_radius()) one_radius = false;
  if (!pending.has_one_brush()) one_brush = false;
}

/// One for all fingers, or one for each. A choice also chooses type 2, which has them.
void LiveWindow::Panel::brushes(flow::LoopSettings& chosen) {
  ImGui::Checkbox("one brush for all fingers", &one_brush);
  const auto before = chosen.brushes;
  for (std::size_t finger = 0; finger < (one_brush ? 1 : finger_names.size()); ++finger) {
    deform::Brush& brush = chosen.brushes[finger];
    ImGui::PushID(static_cast<int>(finger));
    if (ImGui::BeginCombo(one_brush ? flow::setting::brushes.label.data() : finger_names[finger],
                          name_of(brush).data())) {
      for (std::uint8_t number = 0; number < deform::brush_count; ++number) {
        const auto one = static_cast<deform::Brush>(number);
        if (ImGui::Selectable(name_of(one).data(), one == brush)) brush = one;
      }
      ImGui::EndCombo();
    }
    ImGui::PopID();
  }
  if (one_brush) chosen.brushes.fill(chosen.brushes[0]);
  if (chosen.brushes != before) chosen.mode = flow::Mode::type2;
  slider(flow::setting::brush_strength, chosen, 10.0, "%.1f");
  show_help("weaker brush");
}

void LiveWindow::Panel::settings() {
  flow::LoopSettings& chosen = pending.now;
  int mode = static_cast<int>(chosen.mode);
  const float half = ImGui::GetContentRegionAvail().x * 0.64F;
  ImGui::RadioButton("type 1: pull", &mode, 0);
  ImGui::SameLine(half);
  ImGui::RadioButton("clay", &mode, 2);
  show_help("next mode", "Whole hands press the surface.");
  ImGui::RadioButton("type 2: strokes", &mode, 1);
  ImGui::SameLine(half);
  ImGui::RadioButton("parts", &mode, 3);
  show_help("next mode", "A hand that closes takes the part under it, until it opens.");
  chosen.mode = static_cast<flow::Mode>(mode);
  ImGui::PushItemWidth(-label_width);
  if (ImGui::BeginCombo(flow::setting::kernel.label.data(), kernel_words(chosen.kernel))) {
    for (const auto kernel : Pending::kernels)
      if (ImGui::Selectable(kernel_words(kernel), kernel == chosen.kernel)) chosen.kernel = kernel;
    ImGui::EndCombo();
  }
  brushes(chosen);
  slider(flow::setting::keep_volume, chosen, 100.0, "%.2f");
  show_help("more clay",
            "From air to clay: what is pressed in comes out nearby. Above 0, fingertips "
            "hold, and no links keep the surface from folding.");
  bool whole_hand = chosen.hold == flow::Hold::hand;
  ImGui::Checkbox(flow::setting::hold.label.data(), &whole_hand);
  show_help("whole hand");
  chosen.hold = whole_hand ? flow::Hold::hand : flow::Hold::fingertips;
  ImGui::SameLine();
  ImGui::Checkbox(flow::setting::injective.label.data(), &chosen.injective);
  show_help("folding");
  bool smooth = chosen.filter.kind == hand::FilterKind::one_euro;
  ImGui::Checkbox(flow::setting::filter.label.data(), &smooth);
  show_help("filter");
  chosen.filter.kind = smooth ? hand::FilterKind::one_euro : hand::FilterKind::off;
  ImGui::SameLine();
  ImGui::Checkbox(flow::setting::pinches.label.data(), &chosen.filter.close_pinches);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", flow::setting::pinches.help.data());
  ImGui::Checkbox("one radius for all fingers", &one_radius);
  const flow::FingersSetting& radii = flow::setting::radius;
  for (std::size_t finger = 0; finger < (one_radius ? 1 : finger_names.size()); ++finger) {
    auto radius_cm = static_cast<float>(100.0 * chosen.radius_m[finger]);
    if (ImGui::SliderFloat(one_radius ? radii.label.data() : finger_names[finger], &radius_cm,
                           static_cast<float>(100.0 * radii.handy.min),
                           static_cast<float>(100.0 * radii.handy.max), "%.1f cm"))
      chosen.radius_m[finger] = radii.handy.nearest(static_cast<double>(radius_cm) / 100);
  }
  if (one_radius) chosen.radius_m.fill(chosen.radius_m[0]);
  ImGui::PopItemWidth();
}

void LiveWindow::Panel::history(const flow::Frame& frame, Commands& commands) {
  const flow::StepList& list = frame.steps;
  const std::size_t hidden =
      frame.undo_steps - std::min<std::uint64_t>(frame.undo_steps, list.undoable);
  ImGui::BeginChild("steps", ImVec2(0.0F, 96.0F), true);
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
    if (ImGui::Selectable(words, is_present)) go_to_step(list, at, commands);
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
  const double units = frame.units_per_metre;
  const double cm3 = 1e6 / (units * units * units);
  ImGui::Text("volume %.1f cm3, at first %.1f", cm3 * clay.volume, cm3 * clay.first_volume);
}

void LiveWindow::Panel::timing(const flow::Frame& frame, const Gauges& gauges) const {
  ImGui::Text("%g Hz wanted, %s", gauges.rate_hz, name_of(frame.settings.mode).data());
  ImGui::TextWrapped("%llu ticks, %llu missed", static_cast<unsigned long long>(frame.ticks_run),
                     static_cast<unsigned long long>(frame.missed));
  ImGui::TextWrapped("%llu commits, %llu undone", static_cast<unsigned long long>(frame.commits),
                     static_cast<unsigned long long>(frame.undos));
  chart("late", late_ms, "ms");
  chart("uneven", gap_ms, "ms");
  chart("picture", pictures_ms, "ms");
}

void LiveWindow::Panel::hands(const flow::Frame& frame, const Gauges& gauges) const {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    ImGui::PushTextWrapPos(0.0F);
    for (const std::string& line : gauges.devices[slot])
      ImGui::TextUnformatted(line.c_str());
    ImGui::PopTextWrapPos();
    const auto bends = bends_of(hand.pose);
    ImGui::PushID(static_cast<int>(slot));
    ImGui::PlotHistogram("##joints", bends.data(), static_cast<int>(bends.size()), 0,
                         "thumb to little, degrees", 0.0F, 110.0F,
                         ImVec2(ImGui::GetContentRegionAvail().x, 50.0F));
    ImGui::PopID();
  }
}

void LiveWindow::draw_panel(const flow::Frame& frame, const Gauges& gauges, Commands& commands) {
  constexpr float gap = Panel::gap_px;
  const commands::Situation now{frame, gauges.facts};
  const float high = ImGui::GetIO().DisplaySize.y - 2.0F * gap;
  ImGui::SetNextWindowPos(ImVec2(gap, gap));
  ImGui::SetNextWindowSizeConstraints(ImVec2(Panel::width_px, 0.0F),
                                      ImVec2(Panel::width_px, std::max(40.0F, high)));
  if (std::exchange(panel_->fold_asked, false)) ImGui::SetNextWindowCollapsed(!panel_->folded);
  // Without navigation, or Tab, which begins to edit a puppet, would also begin to edit a number.
  const bool open = ImGui::Begin("Nendo", nullptr,
                                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                                     ImGuiWindowFlags_NoNavInputs);
  panel_->folded = ImGui::IsWindowCollapsed();
  if (open) {
    ImGui::TextWrapped("%s   (? for keys)", gauges.model.c_str());
    panel_->buttons(now, gauges, commands);
    panel_->parts(*window_);
    const auto puppet = [&] {
      if (ImGui::CollapsingHeader("Puppet", ImGuiTreeNodeFlags_DefaultOpen))
        Panel::puppet(*editor_, commands);
    };
    const bool edits =
        editor_->is_on() && !editor_->paints_masks(); // and then needs nothing as much as this
    if (edits) puppet();
    if (ImGui::CollapsingHeader("Shaping", ImGuiTreeNodeFlags_DefaultOpen)) {
      panel_->settings();
      panel_->masks(*editor_, now, commands);
    }
    if (ImGui::CollapsingHeader("History", ImGuiTreeNodeFlags_DefaultOpen))
      panel_->history(frame, commands);
    if (!edits) puppet();
    if (frame.clay.is_clay && ImGui::CollapsingHeader("Clay", ImGuiTreeNodeFlags_DefaultOpen))
      Panel::clay(frame);
    if (ImGui::CollapsingHeader("Timing", ImGuiTreeNodeFlags_DefaultOpen))
      panel_->timing(frame, gauges);
    if (ImGui::CollapsingHeader("Gloves", ImGuiTreeNodeFlags_DefaultOpen))
      panel_->hands(frame, gauges);
  }
  ImGui::End();
  if (!commands.empty()) panel_->note.clear();
  panel_->keys(now, *window_, *editor_, commands);
  if (const auto change = panel_->pending.ask()) commands.push_back(*change);
}

void LiveWindow::Panel::ask(const commands::Row& row, const commands::Situation& now,
                            Commands& commands) {
  const commands::Answer answer = commands::press(row, now, pending);
  if (answer.command) commands.push_back(*answer.command);
  note = answer.refusal != nullptr ? answer.refusal : "";
}

/// Executes a command that concerns the window alone.
void LiveWindow::Panel::execute(std::string_view name, SceneWindow& window, PuppetEditor& editor,
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
        execute(row.name, window, editor, commands);
    }
  }
  if (keys_shown)
    draw_key_list(commands::in_window,
                  "right drag on a hand moves it, with shift turns it, with the wheel\n"
                  "pushes and pulls it; while a puppet is edited, a click places a point, a\n"
                  "drag of a point sets where it goes, with shift how it turns, the wheel over\n"
                  "one how far it reaches",
                  keys_shown);
}

} // namespace nendo::viewer
