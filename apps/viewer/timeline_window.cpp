#include "viewer/timeline_window.hpp"

#include <algorithm>
#include <utility>

#include <imgui.h>

#include "commands/commands.hpp"
#include "forms/timeline_panel.hpp"
#include "viewer/command_search.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/pointing.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"
#include "viewer/window_form.hpp"

namespace nendo::viewer {
namespace {

using forms::DopeSheet;
using forms::EditActions;
using forms::EditCommand;
using forms::TimelineView;
using forms::TipDrag;

constexpr const char* mouse_in_timeline =
    "drag on the strip scrubs, wheel zooms it, middle drag shifts it;\n"
    "a key: click selects, drag moves, ctrl drag copies;\n"
    "a ringed fingertip: drag bends the finger, with the wheel away and back";

constexpr float margin_em = 0.4F; ///< about the strip

/// Returns the usual height in pixels of the strip below the picture.
int strip_height(std::size_t lanes) {
  const ImGuiStyle& style = ImGui::GetStyle(); // the font has no size before the first picture
  const float controls = em(1.0F) + 2.0F * style.FramePadding.y + style.ItemSpacing.y;
  return static_cast<int>(scale() * static_cast<float>(DopeSheet::height_for(lanes)) + controls +
                          em(2.0F * margin_em));
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

  forms::TimelinePanel described{true};
  int strip_px = 0; ///< height of the strip in the last picture; 0: there was none
  WindowForm form, strip;
  struct {
    std::optional<hand::Finger> held; ///< the fingertip that the mouse drags
    PlaceMover target;
  } tips;
  CommandSearch search;

  /// Above the strip, where it is scrolled if it is too long.
  void draw(const TimelineView& view, const SceneWindow& window, EditActions& actions) {
    const float gap = em(gap_em), panel_width = em(width_em), top = gap + window.above_px();
    const float high = static_cast<float>(window.scene_size().height) - gap - top;
    begin_pane("Nendo: edit", {gap, top}, {0.0F, 0.0F}, {panel_width, std::max(em(3.0F), high)}, 0);
    described.describe(form, view, actions);
    ImGui::End();
  }

  /// At the window's bottom, over its whole width.
  void draw_strip(const TimelineView& view, EditActions& actions) {
    const ImVec2 all = ImGui::GetIO().DisplaySize;
    const auto height = static_cast<float>(strip_px);
    const float margin = em(margin_em);
    ImGui::SetNextWindowPos(ImVec2(0.0F, all.y - height));
    ImGui::SetNextWindowSize(ImVec2(all.x, height));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(margin, margin));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
    ImGui::Begin("strip", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoScrollWithMouse);
    described.describe_strip(strip, view, actions);
    // In a narrow window, the controls may take two lines.
    strip_px = static_cast<int>(ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y + margin);
    ImGui::End();
    ImGui::PopStyleVar(2);
  }

  /// Handles keys, and draws the list of commands.
  void keys(const TimelineView& view, SceneWindow& window, EditActions& actions) {
    window.follow_view_keys();
    for (const auto* const row :
         search.asked(commands::in_timeline, view.facts, mouse_in_timeline)) {
      window.execute(row->name);
      // The same stroke of Esc may have cancelled the drag of a fingertip.
      const bool is_esc = row->edit && row->edit->command == EditCommand::select_none;
      if (row->edit && !(is_esc && actions.drop)) described.add(row->edit->command, actions);
      if (row->name == "end edit") actions.quit = true;
    }
  }
};

TimelineWindow::TimelineWindow(std::shared_ptr<SceneWindow> window)
    : window_(std::move(window)), panel_(std::make_unique<Panel>()) {}

TimelineWindow::~TimelineWindow() = default;

EditActions TimelineWindow::show(const TimelineView& view, const render::SceneFrame& scene_frame) {
  EditActions actions;
  if (panel_->strip_px == 0) panel_->strip_px = strip_height(view.lanes.size());
  window_->leave_below(panel_->strip_px);
  window_->leave_left(static_cast<int>(em(gap_em + Panel::width_em)));
  window_->begin_picture(scene_frame);
  if (!move_tip(view, scene_frame, actions)) window_->move_camera();
  mark_tips(view, scene_frame);
  panel_->draw_strip(view, actions);
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
