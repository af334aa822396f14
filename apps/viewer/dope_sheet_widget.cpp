#include "viewer/dope_sheet_widget.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "viewer/dope_sheet_drawing.hpp"
#include "viewer/row_button.hpp"
#include "viewer/row_keys.hpp"

namespace nendo::viewer {
namespace {

constexpr float controls_height = 36.0F;
constexpr float margin = 6.0F;
constexpr double drag_begins_px = 3.0;

void tell_what_is_at(const TimelineView& view, const DopeSheet& strip, double x, double y) {
  if (const auto key = strip.key_at(view.lanes, x, y))
    ImGui::SetTooltip("key %zu, %.3f s", key->key, view.lanes[key->lane].keys_s[key->key]);
  else if (const auto mark = strip.mark_at(view.marks, view.lanes.size(), x, y))
    ImGui::SetTooltip("%s, %.3f s", view.marks[*mark].name.c_str(), view.marks[*mark].time_s);
}

// To a frame's time, as Player has it, within the timeline.
double on_a_frame(double time_s, const TimelineView& view) {
  const double frame = std::round(time_s * view.rate_hz);
  const double last = std::floor(view.duration_s * view.rate_hz);
  return std::clamp(frame, 0.0, std::max(0.0, last)) / view.rate_hz;
}

} // namespace

int DopeSheetWidget::height_for(std::size_t lanes) noexcept {
  return static_cast<int>(DopeSheet::height_for(lanes) +
                          static_cast<double>(controls_height + 2.0F * margin));
}

void DopeSheetWidget::draw(const TimelineView& view, const std::optional<Retiming>& shaded,
                           EditActions& actions) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const auto height = static_cast<float>(height_for(view.lanes.size()));
  ImGui::SetNextWindowPos(ImVec2(0.0F, all.y - height));
  ImGui::SetNextWindowSize(ImVec2(all.x, height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(margin, margin));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::Begin("strip", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
  controls(view, actions);
  const ImVec2 corner(margin, all.y - height + margin + controls_height);
  const ImVec2 size(std::max(64.0F, all.x - 2.0F * margin),
                    static_cast<float>(DopeSheet::height_for(view.lanes.size())));
  strip_.fit(static_cast<double>(size.x), view.duration_s);
  if (std::exchange(head_s_, view.head_s) != view.head_s) strip_.follow(view.head_s);
  ImGui::SetCursorScreenPos(corner);
  ImGui::InvisibleButton("keys", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const auto x = static_cast<double>(mouse.x - corner.x);
  const auto y = static_cast<double>(mouse.y - corner.y);
  follow_mouse(view, x, y, actions);
  StripLook look{corner, size, {}, shaded};
  if (ImGui::IsItemHovered()) {
    look.pointed_at = strip_.key_at(view.lanes, x, y);
    if (!taken_) tell_what_is_at(view, strip_, x, y);
  }
  draw_strip(strip_, view, look);
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void DopeSheetWidget::controls(const TimelineView& view, EditActions& actions) const {
  constexpr float button_width = 34.0F;
  edit_buttons(commands::Buttons::head, view.facts, button_width, actions.commands);
  ImGui::SameLine();
  bool loops = view.loops;
  if (ImGui::Checkbox("loop", &loops)) actions.commands.push_back(EditCommand::loop);
  show_help("loop");
  ImGui::SameLine();
  auto speed = static_cast<float>(view.speed);
  ImGui::SetNextItemWidth(110.0F);
  if (ImGui::SliderFloat("##speed", &speed, 0.1F, 4.0F, "speed %.2f", ImGuiSliderFlags_Logarithmic))
    actions.speed = static_cast<double>(speed);
  ImGui::SameLine();
  ImGui::Text("%.3f s of %.3f s", view.head_s, view.duration_s);
  ImGui::SameLine();
  if (view.computing)
    ImGui::TextDisabled("shapes made to %.2f s", view.computed_s);
  else if (view.shape_is_old)
    ImGui::TextDisabled("the shape is of before the last edits");
}

void DopeSheetWidget::follow_mouse(const TimelineView& view, double x, double y,
                                   EditActions& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && io.MouseWheel != 0.0F)
    strip_.zoom(x, static_cast<double>(io.MouseWheel));
  if (ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Middle))
    strip_.pan(static_cast<double>(io.MouseDelta.x));
  if (ImGui::IsItemActivated() && ImGui::IsMouseClicked(ImGuiMouseButton_Left))
    press(view, x, y, actions);
  if (taken_ && is_struck(commands::row_of(EditCommand::select_none))) {
    if (taken_->moved) actions.drop = true;
    taken_.reset();
  }
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    drag(view, x, actions);
    return;
  }
  if (taken_ && taken_->moved) actions.keep = true;
  taken_.reset();
  scrubs_ = false;
}

void DopeSheetWidget::press(const TimelineView& view, double x, double y, EditActions& actions) {
  if (const auto key = strip_.key_at(view.lanes, x, y)) {
    actions.select = key;
    taken_ = Taken{*key, x, false};
  } else if (const auto mark = strip_.mark_at(view.marks, view.lanes.size(), x, y)) {
    actions.seek_s = view.marks[*mark].time_s;
  } else {
    scrubs_ = true;
  }
}

void DopeSheetWidget::drag(const TimelineView& view, double x, EditActions& actions) {
  if (scrubs_) actions.seek_s = strip_.time_at(x);
  if (!taken_) return;
  if (!taken_->moved) {
    if (std::abs(x - taken_->pressed_x) < drag_begins_px) return;
    taken_->moved = true;
  }
  actions.tried = KeyDrag{taken_->key, on_a_frame(strip_.time_at(x), view), ImGui::GetIO().KeyCtrl};
}

} // namespace nendo::viewer
