#include "viewer/timeline_window.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <imgui.h>

#include "commands/commands.hpp"
#include "viewer/command_search.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/dope_sheet_widget.hpp"
#include "viewer/pointing.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

constexpr const char* mouse_words =
    "drag on the strip scrubs, wheel zooms it, middle drag shifts it;\n"
    "a key: click selects, drag moves, ctrl drag copies;\n"
    "a ringed fingertip: drag bends the finger, with the wheel away and back";

void seconds(const char* label, double& value_s, double head_s) {
  ImGui::PushID(label);
  ImGui::SetNextItemWidth(em(7.4F));
  ImGui::InputDouble(label, &value_s, 0.0, 0.0, "%.3f s");
  ImGui::SameLine();
  if (ImGui::SmallButton("= head")) value_s = head_s;
  ImGui::PopID();
}

constexpr ImU32 ring_colour = IM_COL32(255, 160, 40, 230);
constexpr ImU32 pointed_tip_colour = IM_COL32(205, 60, 15, 255);
constexpr float ring_px = 8.0F;

/// The hand whose fingers can be bent now; null: none's.
const render::SceneHand* bendable_hand(const TimelineView& view,
                                       const render::SceneFrame& scene_frame) {
  if (!view.at_selected || !view.selected) return nullptr;
  const Side side = view.lanes[view.selected->lane].side;
  const auto& hand = scene_frame.hands[flow::Placement::index_of(side)];
  return hand ? &*hand : nullptr;
}

} // namespace

struct TimelineWindow::Panel {
  static constexpr float width_em = 20.0F;

  DopeSheetWidget strip;
  struct {
    std::optional<hand::Finger> held; ///< the fingertip that the mouse drags
    PlaceMover target;
  } tips;
  Retiming retiming{0.0, 0.0, 2.0};
  bool retiming_shown = false;
  CommandSearch search;
  float blend = 0.0F;
  bool blends = false; ///< the mouse holds the slider

  /// Above the strip, where it is scrolled if it is too long.
  void draw(const TimelineView& view, const SceneWindow& window, EditActions& actions) {
    const float gap = em(gap_em), panel_width = em(width_em), top = gap + window.above_px();
    const float high = static_cast<float>(window.scene_size().height) - gap - top;
    begin_pane("Nendo: edit", {gap, top}, {0.0F, 0.0F}, {panel_width, std::max(em(3.0F), high)}, 0);
    ImGui::PushTextWrapPos(panel_width - em(0.8F));
    file(view, actions);
    if (section("Key", "The selected key.", true)) key(view, actions);
    if (!view.functions.empty() &&
        section("Functions", "What each function of the puppet is at the play head.", true))
      functions(view);
    retiming_shown = section("Timeline", "Changes of the whole timeline.", false);
    if (retiming_shown) whole(view, actions);
    if (!view.message.empty()) {
      ImGui::Separator();
      if (view.refused) ImGui::PushStyleColor(ImGuiCol_Text, warning());
      ImGui::TextUnformatted(view.message.c_str());
      if (view.refused) ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
    ImGui::End();
  }

  /// Handles keys, and draws the list of commands.
  void keys(const TimelineView& view, SceneWindow& window, EditActions& actions) {
    window.follow_view_keys();
    for (const auto* const row : search.asked(commands::in_timeline, view.facts, mouse_words)) {
      window.execute(row->name);
      // The same stroke of Esc may have cancelled a drag.
      if (row->edit && !(row->edit->command == EditCommand::select_none && actions.drop))
        actions.commands.push_back(row->edit->command);
      if (row->name == "end edit") actions.quit = true;
    }
  }

private:
  static void file(const TimelineView& view, EditActions& actions) {
    const std::string name = std::filesystem::path(view.file).filename().string();
    ImGui::Text("%s%s   (? for keys)", name.c_str(), view.modified ? " *" : "");
    edit_buttons(commands::Buttons::file, view.facts, 0.0F, actions.commands);
  }

  void key(const TimelineView& view, EditActions& actions) {
    const bool any = view.selected.has_value();
    if (any) {
      const StripLane& lane = view.lanes[view.selected->lane];
      ImGui::Text("%s hand, key %zu of %zu, at %.3f s", std::string(name_of(lane.side)).c_str(),
                  view.selected->key, lane.keys_s.size(), lane.keys_s[view.selected->key]);
    } else {
      ImGui::TextDisabled("click a key on the strip to select it");
    }
    edit_buttons(commands::Buttons::key, view.facts, 0.0F, actions.commands);
    ImGui::BeginDisabled(!any);
    if (number_field("blend", blend, 0.0F, 1.0F, "%.2f")) {
      blends = true;
      actions.tried = KeyBlend{static_cast<double>(std::clamp(blend, 0.0F, 1.0F))};
    }
    ImGui::EndDisabled();
    show_text("With its neighbours: what would be without it is 1.");
    if (blends && !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
      actions.keep = true;
      blends = false;
      blend = 0.0F;
    }
    if (any)
      ImGui::TextDisabled("%s", view.at_selected
                                    ? "drag a ringed fingertip to bend its finger"
                                    : "the head is elsewhere: click the key to bend its fingers");
  }

  /// A line for each: its value, and its curve over the whole timeline with the play head.
  static void functions(const TimelineView& view) {
    const double head = view.duration_s > 0.0 ? view.head_s / view.duration_s : 0.0;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(em(0.5F), em(0.15F)));
    for (const FunctionCurve& function : view.functions) {
      char words[96];
      std::snprintf(words, sizeof words, "%s %.2f", function.name.c_str(), function.value);
      ImGui::AlignTextToFramePadding();
      ImGui::TextUnformatted(words);
      note_control("function " + function.name, words);
      show_text("The value of " + function.name + " at the play head, and its curve.");
      ImGui::SameLine(em(10.8F));
      const auto& values = function.over_time;
      const bool is_signed = std::ranges::any_of(values, [](float one) { return one < -0.05F; });
      ImGui::PlotLines(("##" + function.name).c_str(), values.data(),
                       static_cast<int>(values.size()), 0, nullptr, is_signed ? -1.0F : 0.0F, 1.0F,
                       ImVec2(ImGui::GetContentRegionAvail().x, em(1.7F)));
      const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
      const float x = low.x + static_cast<float>(head) * (high.x - low.x);
      ImGui::GetWindowDrawList()->AddLine({x, low.y}, {x, high.y}, ImGui::GetColorU32(warning()),
                                          1.5F * scale());
    }
    ImGui::PopStyleVar();
  }

  void whole(const TimelineView& view, EditActions& actions) {
    edit_buttons(commands::Buttons::whole, view.facts, 0.0F, actions.commands);
    if (retiming.to_s <= retiming.from_s) retiming.to_s = view.duration_s;
    seconds("from", retiming.from_s, view.head_s);
    seconds("to", retiming.to_s, view.head_s);
    ImGui::SetNextItemWidth(em(7.4F));
    ImGui::InputDouble("times as long", &retiming.scale, 0.0, 0.0, "%.3f");
    if (ImGui::Button("Retime")) actions.retiming = retiming;
  }
};

TimelineWindow::TimelineWindow(std::shared_ptr<SceneWindow> window)
    : window_(std::move(window)), panel_(std::make_unique<Panel>()) {}

TimelineWindow::~TimelineWindow() = default;

EditActions TimelineWindow::show(const TimelineView& view, const render::SceneFrame& scene_frame) {
  EditActions actions;
  window_->leave_below(DopeSheetWidget::height_for(view.lanes.size()));
  window_->leave_left(static_cast<int>(em(gap_em + Panel::width_em)));
  window_->begin_picture(scene_frame);
  if (!move_tip(view, scene_frame, actions)) window_->move_camera();
  mark_tips(view, scene_frame);
  panel_->strip.draw(view, panel_->retiming_shown ? std::optional(panel_->retiming) : std::nullopt,
                     actions);
  panel_->draw(view, *window_, actions);
  panel_->keys(view, *window_, actions);
  if (window_->take_close_request()) actions.quit = true;
  window_->end_picture();
  return actions;
}

/// True: the mouse holds a fingertip, and does nothing else.
bool TimelineWindow::move_tip(const TimelineView& view, const render::SceneFrame& scene_frame,
                              EditActions& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  auto& [held, tip] = panel_->tips;
  const render::SceneHand* const hand = bendable_hand(view, scene_frame);
  const render::Camera camera = window_->stage_camera();
  const render::Size size = window_->scene_size();
  if (!io.WantCaptureMouse && hand != nullptr && ImGui::IsMouseClicked(ImGuiMouseButton_Left))
    if ((held = tip_at(camera, hand->pose, pointer_px(), size)))
      tip.begin(hand->pose.fingertip_positions().col(static_cast<Eigen::Index>(*held)),
                Eigen::Vector3d::Zero());
  if (!held) return false;
  const bool given_up = is_struck(commands::row_of(EditCommand::select_none));
  if (given_up || hand == nullptr || !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    (given_up ? actions.drop : actions.keep) = true;
    held.reset();
    return true;
  }
  const Eigen::Vector2d by = moved_px();
  tip.shift(camera, by.x(), by.y(), size.height);
  tip.push(camera, static_cast<double>(io.MouseWheel));
  if (!by.isZero(0.0) || io.MouseWheel != 0.0F) actions.tried = TipDrag{*held, tip.place_m()};
  return true;
}

/// Rings about what can be dragged, and a line to where it is to be.
void TimelineWindow::mark_tips(const TimelineView& view,
                               const render::SceneFrame& scene_frame) const {
  const render::SceneHand* const hand = bendable_hand(view, scene_frame);
  if (hand == nullptr) return;
  const render::Camera camera = window_->stage_camera();
  const render::Size size = window_->scene_size();
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto& [held, held_tip] = panel_->tips;
  const auto pointed_at = held || ImGui::GetIO().WantCaptureMouse
                              ? held
                              : tip_at(camera, hand->pose, pointer_px(), size);
  const auto tips = hand->pose.fingertip_positions();
  for (Eigen::Index finger = 0; finger < tips.cols(); ++finger) {
    const auto pixel = pixel_of(camera, tips.col(finger), size);
    if (!pixel || pixel->y() > size.height) continue;
    const bool marked = pointed_at == static_cast<hand::Finger>(finger);
    list.AddCircle(in_window(*pixel), ring_px, marked ? pointed_tip_colour : ring_colour, 0,
                   marked ? 3.0F : 2.0F);
    if (!marked || !held) continue;
    if (const auto target = pixel_of(camera, held_tip.place_m(), size))
      list.AddLine(in_window(*pixel), in_window(*target), pointed_tip_colour, 1.5F);
  }
}

} // namespace nendo::viewer
