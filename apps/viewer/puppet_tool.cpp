#include "viewer/puppet_tool.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <imgui.h>

#include <nendo/base/units.hpp>

#include "viewer/pointing.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double still_px = 4.0; // a click that moves farther is a drag

/// By which the mouse has turned what is at that pixel, counter-clockwise.
double turned_deg(const Vector2d& pivot, const Vector2d& from, const Vector2d& to) {
  constexpr double min_px = 4.0; // nearer to the pivot, no direction is meant
  const Vector2d a = from - pivot, b = to - pivot;
  if (a.norm() < min_px || b.norm() < min_px) return 0.0;
  return to_degrees(std::atan2(a.y() * b.x() - a.x() * b.y(), a.dot(b))); // y points down
}

constexpr float above_m = 0.0015F; // the surface, so that patches are seen
constexpr double mark_px = 6.0;
constexpr std::size_t max_named = 16; // points; of more, only those that a person points at
constexpr double reach_px = 11.0;     // of the mouse, to a mark

render::Material patch(const Vector3f& colour, float opacity) {
  render::Material material{colour, 0.0F, opacity, opacity};
  material.shadowless = true;
  return material;
}

const Vector3f reach_colour{0.02F, 0.30F, 0.75F};
const Vector3f mask_colour{0.45F, 0.03F, 0.50F};
const Vector3f erased_colour{0.90F, 0.90F, 0.90F};

bool is_masked(const Vector3d& place, const std::vector<puppet::Mask>& masks) {
  return std::any_of(masks.begin(), masks.end(), [&](const puppet::Mask& mask) {
    return (mask.at - place).norm() < puppet::half_of_mask * mask.radius;
  });
}

/// The shaft and two barbs.
void draw_way(ImDrawList& list, const Vector2d& from, const Vector2d& to, ImU32 colour) {
  const Vector2d way = to - from;
  const double length = way.norm();
  if (length < 3.0) return;
  const Vector2d along = way / length, beside(-along.y(), along.x());
  const double barb = std::min(9.0, 0.5 * length);
  list.AddLine(in_window(from), in_window(to), colour, 2.5F);
  list.AddTriangleFilled(in_window(to), in_window(to - barb * along + 0.5 * barb * beside),
                         in_window(to - barb * along - 0.5 * barb * beside), colour);
}

/// Returns which of the places has its mark under the mouse.
std::optional<std::size_t> mark_at_mouse(const ModelPicture& picture,
                                         const deform::Points& places) {
  const auto found =
      nearest_in_picture(picture.camera, places, pointer_px(), picture.size, reach_px);
  return found ? std::optional(static_cast<std::size_t>(found->at)) : std::nullopt;
}

/// Turns the chosen function by the way of the mouse.
void drag_turn(const ModelPicture& picture, PuppetEditor& editor) {
  const puppet::AxisTurn turn = *editor.dragged_turn();
  const auto pivot = pixel_of(picture.camera, turn.through, picture.size);
  if (!pivot) return;
  const bool away = picture.camera.axes().row(2).dot(turn.axis) < 0.0;
  const Vector2d to = pointer_px();
  editor.turn_by((away ? -1.0 : 1.0) * turned_deg(*pivot, to - moved_px(), to));
}

} // namespace

ModelPicture::ModelPicture(const SceneWindow& window, double units_per_metre)
    : camera(window.stage_camera()), size(window.scene_size()) {
  camera.target *= units_per_metre;
  camera.distance_m *= units_per_metre;
}

std::optional<SurfaceHit> ModelPicture::hit_of_mouse(const deform::Mesh& shape,
                                                     const deform::Points& rest) const {
  return first_hit(shape, ray_at(camera, pointer_px(), size), &rest);
}

const std::vector<render::Surface>& PuppetMarks::veils(const PuppetEditor& editor,
                                                       const render::SceneBuilder& builder) {
  if (version_ != editor.version()) make(editor, builder);
  version_ = editor.version();
  return veils_;
}

void PuppetMarks::make(const PuppetEditor& editor, const render::SceneBuilder& builder) {
  if (model_version_ != editor.model_version()) {
    model_version_ = editor.model_version();
    render::SceneFrame seen;
    seen.vertices = editor.seen().vertices;
    render::Scene scene;
    builder.build(seen, {.ground = false}, scene);
    model_ = std::move(scene.model);
    for (std::size_t at = 0; at < model_.places.size(); ++at)
      model_.places[at] += above_m * model_.normals[at];
    graph_.reset();
  }
  veils_.clear();
  add_reach(editor);
  add_masks(editor);
}

/// Of the triangles whose vertices it takes.
void PuppetMarks::add_veil(const render::Material& material,
                           const std::function<bool(std::uint32_t vertex)>& takes) {
  veils_.push_back(part_of(model_, material, [&](std::span<const std::uint32_t, 3> corners) {
    return std::all_of(corners.begin(), corners.end(), takes);
  }));
}

void PuppetMarks::add_reach(const PuppetEditor& editor) {
  const std::size_t chosen = editor.point();
  if (!editor.pending() && chosen == PuppetEditor::none) return;
  const Vector3d at = editor.pending() ? editor.pending()->at
                                       : editor.rig().starts().col(static_cast<Index>(chosen));
  const double radius = editor.radius();
  const deform::Mesh& model = editor.model();
  Eigen::VectorXd distances;
  if (editor.rig().puppet().distance == puppet::Distance::surface) {
    if (!graph_) graph_.emplace(model);
    distances = graph_->distances(deform::nearest_position(model, at), radius);
  } else {
    distances = (model.vertices.colwise() - at).colwise().norm();
  }
  // Rings, each fainter than the one inside, as the functions fall off. Depth lets only the first
  // be seen that is drawn at a place, so the inner ones come first.
  constexpr std::array opacities{0.62F, 0.46F, 0.32F, 0.18F};
  const auto ring_of = [&](std::uint32_t vertex) {
    return static_cast<double>(opacities.size()) * distances[vertex] / radius;
  };
  for (std::size_t ring = 0; ring < opacities.size(); ++ring) {
    const auto outer = static_cast<double>(ring + 1);
    const auto takes = [&](std::uint32_t vertex) { return ring_of(vertex) < outer; };
    add_veil(patch(reach_colour, opacities[ring]), takes);
  }
}

void PuppetMarks::add_masks(const PuppetEditor& editor) {
  const auto& masks = editor.rig().puppet().masks;
  const deform::Points& vertices = editor.model().vertices;
  const auto veil_of = [&](const std::vector<puppet::Mask>& balls, const Vector3f& colour,
                           bool inverted = false) {
    if (balls.empty() && !inverted) return;
    std::vector<bool> takes(static_cast<std::size_t>(vertices.cols()));
    for (std::size_t at = 0; at < takes.size(); ++at)
      takes[at] = is_masked(vertices.col(static_cast<Index>(at)), balls) != inverted;
    add_veil(patch(colour, 0.55F), [&](std::uint32_t vertex) { return takes[vertex]; });
  };
  std::vector<puppet::Mask> painted;
  for (const Vector3d& at : editor.stroke())
    painted.push_back({at, editor.brush_radius() / puppet::half_of_mask});
  veil_of(painted, editor.erases() ? erased_colour : mask_colour);
  veil_of(masks, mask_colour, editor.rig().puppet().inverted);
}

void draw_points(const PuppetEditor& editor, const ModelPicture& picture, std::size_t hovered) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto pixel = [&](const Vector3d& place) {
    return pixel_of(picture.camera, place, picture.size);
  };
  constexpr ImU32 dark = IM_COL32(20, 20, 20, 230), white = IM_COL32(255, 255, 255, 255);
  constexpr ImU32 moved = IM_COL32(240, 140, 20, 255), pinned = IM_COL32(120, 150, 190, 255);
  constexpr ImU32 faint = IM_COL32(225, 225, 225, 220);
  constexpr ImU32 fresh = IM_COL32(60, 190, 90, 255);
  const auto& points = editor.rig().puppet().points;
  const std::size_t chosen = editor.pending() ? PuppetEditor::none : editor.point();
  constexpr auto mark = static_cast<float>(mark_px);
  for (std::size_t at = 0; at < points.size(); ++at) {
    const Vector3d start = editor.rig().starts().col(static_cast<Index>(at));
    const auto place = pixel(start);
    if (!place) continue;
    const Vector3d way = editor.way_of(at);
    if (!way.isZero(0.0))
      if (const auto end = pixel(start + way))
        draw_way(list, *place, *end, at == chosen ? white : IM_COL32(255, 255, 255, 150));
    const ImVec2 middle = in_window(*place);
    const ImU32 colour = points[at].is_pin ? pinned : moved;
    if (points[at].is_pin)
      list.AddRectFilled({middle.x - mark, middle.y - mark}, {middle.x + mark, middle.y + mark},
                         colour, 1.5F);
    else
      list.AddCircleFilled(middle, mark, colour);
    list.AddCircle(middle, mark + 1.5F, at == chosen || at == hovered ? white : dark, 0, 2.0F);
    const bool is_meant = at == chosen || at == hovered;
    if (!is_meant && points.size() > max_named) continue;
    list.AddText({middle.x + 11.0F, middle.y - 15.0F}, dark, points[at].name.c_str());
    list.AddText({middle.x + 10.0F, middle.y - 16.0F}, is_meant ? white : faint,
                 points[at].name.c_str());
  }
  if (!editor.pending()) return;
  if (const auto place = pixel(editor.pending()->at)) {
    list.AddCircleFilled(in_window(*place), mark, fresh);
    list.AddCircle(in_window(*place), mark + 1.5F, white, 0, 2.0F);
  }
}

bool PuppetTool::brush(const ModelPicture& picture, PuppetEditor& editor) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.MouseWheel != 0.0F) editor.scale_radius(static_cast<double>(io.MouseWheel));
  const bool begins = ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (!paints_ && !begins) return io.MouseWheel != 0.0F;
  const auto place = picture.hit_of_mouse(editor.seen(), editor.model().vertices);
  if (begins) paints_ = place.has_value(); // beside the model, the mouse turns the camera
  if (!paints_) return io.MouseWheel != 0.0F;
  if (place) editor.paint(*place, io.KeyShift);
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) return true;
  paints_ = false;
  editor.end_stroke();
  return true;
}

void PuppetTool::drag(const ModelPicture& picture, PuppetEditor& editor) {
  if (editor.dragged_turn() != nullptr) {
    drag_turn(picture, editor);
  } else {
    const Vector3d start = editor.rig().starts().col(static_cast<Index>(editor.point()));
    const Vector2d by = moved_px();
    editor.drag(way_in_picture(picture.camera, start + editor.way_of(editor.point()), by.x(),
                               by.y(), picture.size.height));
  }
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) editor.end_drag();
}

/// True: the press or the wheel is for a point.
bool PuppetTool::take_point(const ModelPicture& picture, PuppetEditor& editor) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool is_pressed = ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (hovered_ == PuppetEditor::none) {
    if (!is_pressed || !editor.pending() || !mark_at_mouse(picture, editor.pending()->at))
      return false;
    // It cannot go anywhere yet, and the camera is not meant.
    holds_pending_ = true;
    editor.ask_for_finger();
    return true;
  }
  if (!is_pressed && io.MouseWheel == 0.0F) return false;
  editor.forget_place();
  if (io.MouseWheel != 0.0F) {
    if (editor.point() != hovered_) editor.choose_point(hovered_);
    editor.scale_radius(static_cast<double>(io.MouseWheel));
  } else if (io.KeyShift) {
    editor.begin_turn(hovered_, picture.camera.axes().row(2).transpose());
  } else {
    editor.begin_drag(hovered_);
  }
  return true;
}

bool PuppetTool::follow(const ModelPicture& picture, PuppetEditor& editor) {
  if (editor.is_dragging()) {
    drag(picture, editor);
    return true;
  }
  hovered_ = PuppetEditor::none;
  if (holds_pending_) {
    holds_pending_ = ImGui::IsMouseDown(ImGuiMouseButton_Left);
    return true;
  }
  if (ImGui::GetIO().WantCaptureMouse && !paints_) return false;
  if (editor.brushes()) return brush(picture, editor);
  hovered_ = mark_at_mouse(picture, editor.rig().starts()).value_or(PuppetEditor::none);
  if (take_point(picture, editor)) return true;
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
    pressed_at_ = pointer_px();
    return true; // the way to here is no drag of the camera
  }
  if (!pressed_at_ || !ImGui::IsMouseReleased(ImGuiMouseButton_Left)) return false;
  const bool is_click = (pointer_px() - *std::exchange(pressed_at_, {})).norm() <= still_px;
  if (is_click)
    if (const auto place = picture.hit_of_mouse(editor.seen(), editor.model().vertices))
      editor.place(*place);
  return false;
}

} // namespace nendo::viewer
