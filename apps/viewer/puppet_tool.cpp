#include "viewer/puppet_tool.hpp"

#include <cmath>

#include <imgui.h>

#include <nendo/base/units.hpp>

#include "viewer/pointing.hpp"

namespace nendo::viewer {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double still_px = 4.0; // a click that moves farther is a drag

Vector2d pointer_now() {
  const ImVec2 at = ImGui::GetIO().MousePos;
  return {static_cast<double>(at.x), static_cast<double>(at.y)};
}

/// By which the mouse has turned what is at that pixel, counter-clockwise.
double turned_deg(const Vector2d& pivot, const Vector2d& from, const Vector2d& to) {
  constexpr double min_px = 4.0; // nearer to the pivot, no direction is meant
  const Vector2d a = from - pivot, b = to - pivot;
  if (a.norm() < min_px || b.norm() < min_px) return 0.0;
  return to_degrees(std::atan2(a.y() * b.x() - a.x() * b.y(), a.dot(b))); // y points down
}

} // namespace

void PuppetTool::turn(const render::Camera& camera, render::Size size, double units_per_metre,
                      PuppetEditor& editor) {
  const puppet::AxisTurn turn = *editor.dragged_turn();
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  const Vector2d to = pointer_now();
  const Vector2d from = to - Vector2d(static_cast<double>(moved.x), static_cast<double>(moved.y));
  const auto pivot = pixel_of(camera, turn.through / units_per_metre, size);
  if (!pivot) return;
  const bool away = camera.axes().row(2).dot(turn.axis) < 0.0;
  editor.turn_by((away ? -1.0 : 1.0) * turned_deg(*pivot, from, to));
}

std::optional<SurfaceHit> PuppetTool::hit(const SceneWindow& window, double units_per_metre,
                                          const PuppetEditor& editor) {
  Ray ray = ray_at(window.stage_camera(), pointer_now(), window.scene_size());
  ray.from *= units_per_metre;
  return first_hit(editor.seen(), ray, &editor.model().vertices);
}

bool PuppetTool::brush(const SceneWindow& window, double units_per_metre, PuppetEditor& editor) {
  const bool begins = ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (!paints_ && !begins) return false;
  const auto place = hit(window, units_per_metre, editor);
  if (begins) paints_ = place.has_value(); // beside the model, the mouse turns the camera
  if (!paints_) return false;
  if (place) editor.paint(*place, ImGui::GetIO().KeyShift);
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) return true;
  paints_ = false;
  editor.end_stroke();
  return true;
}

bool PuppetTool::follow(const SceneWindow& window, double units_per_metre, PuppetEditor& editor) {
  const ImGuiIO& io = ImGui::GetIO();
  const render::Camera camera = window.stage_camera();
  const render::Size size = window.scene_size();
  if (editor.dragged_turn() != nullptr) {
    turn(camera, size, units_per_metre, editor);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) editor.end_drag();
    return true;
  }
  if (editor.is_dragging()) {
    const Vector3d start = editor.rig().starts().col(static_cast<Eigen::Index>(editor.point()));
    const Vector3d end_m = (start + editor.way_of(editor.point())) / units_per_metre;
    editor.drag(units_per_metre *
                way_in_picture(camera, end_m, static_cast<double>(io.MouseDelta.x),
                               static_cast<double>(io.MouseDelta.y), size.height));
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) editor.end_drag();
    return true;
  }
  hovered_ = PuppetEditor::none;
  if (holds_pending_) {
    holds_pending_ = ImGui::IsMouseDown(ImGuiMouseButton_Left);
    return true;
  }
  if (io.WantCaptureMouse && !paints_) return false;
  if (editor.brushes()) {
    if (io.MouseWheel != 0.0F) editor.scale_radius(static_cast<double>(io.MouseWheel));
    return brush(window, units_per_metre, editor) || io.MouseWheel != 0.0F;
  }
  hovered_ = point_at(editor, camera, size, units_per_metre, pointer_now());
  if (hovered_ != PuppetEditor::none && io.MouseWheel != 0.0F) {
    editor.forget_place();
    if (editor.point() != hovered_) editor.choose_point(hovered_);
    editor.scale_radius(static_cast<double>(io.MouseWheel));
    return true;
  }
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
    if (hovered_ != PuppetEditor::none) {
      editor.forget_place();
      if (io.KeyShift)
        editor.begin_turn(hovered_, camera.axes().row(2).transpose());
      else
        editor.begin_drag(hovered_);
      return true;
    }
    if (is_at_pending(editor, camera, size, units_per_metre, pointer_now())) {
      // It cannot go anywhere yet, and the camera is not meant.
      holds_pending_ = true;
      editor.ask_for_finger();
      return true;
    }
    pressed_at_ = pointer_now();
    return true; // the way to here is no drag of the camera
  }
  if (pressed_at_ && ImGui::IsMouseReleased(ImGuiMouseButton_Left)) {
    const bool is_click = (pointer_now() - *pressed_at_).norm() <= still_px;
    pressed_at_.reset();
    if (is_click)
      if (const auto place = hit(window, units_per_metre, editor)) editor.place(*place);
  }
  return false;
}

} // namespace nendo::viewer
