#include "viewer/timeline_window.hpp"

#include <utility>

#include <imgui.h>

#include "viewer/pointing.hpp"
#include "viewer/row_keys.hpp"
#include "viewer/timeline_panel.hpp"

namespace nendo::viewer {
namespace {

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

TimelineWindow::TimelineWindow(std::unique_ptr<SceneWindow> window)
    : window_(std::move(window)), panel_(std::make_unique<Panel>()) {}

TimelineWindow::~TimelineWindow() = default;

Result<std::unique_ptr<TimelineWindow>>
TimelineWindow::open(const std::string& title, render::Size size, const std::string& instead) {
  auto window = SceneWindow::open(title, size, instead);
  if (!window) return window.error();
  return std::unique_ptr<TimelineWindow>(new TimelineWindow(*std::move(window)));
}

EditActions TimelineWindow::show(const TimelineView& view, const render::SceneFrame& scene_frame) {
  EditActions actions;
  window_->leave_below(DopeSheetWidget::height_for(view.lanes.size()));
  window_->leave_left(Panel::gap_px + Panel::width_px);
  window_->begin_picture(scene_frame);
  if (!move_tip(view, scene_frame, actions)) window_->move_camera();
  mark_tips(view, scene_frame);
  panel_->strip.draw(view, panel_->retiming_shown ? std::optional(panel_->retiming) : std::nullopt,
                     actions);
  panel_->draw(view, actions);
  panel_->keys(*window_, actions);
  panel_->leave(view, window_->take_close_request(), actions);
  window_->end_picture();
  return actions;
}

/// True: the mouse holds a fingertip, and does nothing else.
bool TimelineWindow::move_tip(const TimelineView& view, const render::SceneFrame& scene_frame,
                              EditActions& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  TipMover& tips = panel_->tips;
  const render::SceneHand* const hand = bendable_hand(view, scene_frame);
  const render::Camera camera = window_->stage_camera();
  const render::Size size = window_->scene_size();
  if (!io.WantCaptureMouse && hand != nullptr && ImGui::IsMouseClicked(ImGuiMouseButton_Left))
    if (const auto finger =
            TipMover::tip_at(camera, hand->pose, {io.MousePos.x, io.MousePos.y}, size))
      tips.take(hand->pose, *finger);
  if (!tips.finger()) return false;
  const bool given_up = is_struck(commands::row_of(EditCommand::select_none));
  if (given_up || hand == nullptr || !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    (given_up ? actions.drop : actions.keep) = true;
    tips.let_go();
    return true;
  }
  tips.shift(camera, static_cast<double>(io.MouseDelta.x), static_cast<double>(io.MouseDelta.y),
             size.height);
  tips.push(camera, static_cast<double>(io.MouseWheel));
  if (io.MouseDelta.x != 0.0F || io.MouseDelta.y != 0.0F || io.MouseWheel != 0.0F)
    actions.tried = TipDrag{*tips.finger(), tips.target_m()};
  return true;
}

/// Rings about what can be dragged, and a line to where it is to be.
void TimelineWindow::mark_tips(const TimelineView& view,
                               const render::SceneFrame& scene_frame) const {
  const render::SceneHand* const hand = bendable_hand(view, scene_frame);
  if (hand == nullptr) return;
  const ImGuiIO& io = ImGui::GetIO();
  const render::Camera camera = window_->stage_camera();
  const render::Size size = window_->scene_size();
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto held = panel_->tips.finger();
  const auto pointed_at =
      held || io.WantCaptureMouse
          ? held
          : TipMover::tip_at(camera, hand->pose, {io.MousePos.x, io.MousePos.y}, size);
  const auto on_screen = [](const Eigen::Vector2d& pixel) {
    return ImVec2(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  };
  const auto tips = hand->pose.fingertip_positions();
  for (Eigen::Index finger = 0; finger < tips.cols(); ++finger) {
    const auto pixel = pixel_of(camera, tips.col(finger), size);
    if (!pixel || pixel->y() > size.height) continue;
    const bool marked = pointed_at == static_cast<hand::Finger>(finger);
    list.AddCircle(on_screen(*pixel), ring_px, marked ? pointed_tip_colour : ring_colour, 0,
                   marked ? 3.0F : 2.0F);
    if (!marked || !held) continue;
    if (const auto target = pixel_of(camera, panel_->tips.target_m(), size))
      list.AddLine(on_screen(*pixel), on_screen(*target), pointed_tip_colour, 1.5F);
  }
}

} // namespace nendo::viewer
