#include "viewer/window_drawing.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <imgui.h>

#include "viewer/controls.hpp"
#include "viewer/picture_card.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

using forms::Drawing;
using Kind = Drawing::Kind;
using Pictures = std::map<std::shared_ptr<const render::Image>, gl::Picture>;

ImU32 colour_of(Drawing::Colour colour) {
  switch (colour) {
  case Drawing::Colour::window:
    return ImGui::GetColorU32(ImGuiCol_WindowBg);
  case Drawing::Colour::control:
    return ImGui::GetColorU32(ImGuiCol_PopupBg);
  case Drawing::Colour::field:
    return ImGui::GetColorU32(ImGuiCol_FrameBg);
  case Drawing::Colour::line:
    return ImGui::GetColorU32(ImGuiCol_Border);
  case Drawing::Colour::ink:
    return ImGui::GetColorU32(ImGuiCol_Text);
  case Drawing::Colour::soft:
    return ImGui::GetColorU32(ImGuiCol_TextDisabled);
  case Drawing::Colour::chart:
    return ImGui::GetColorU32(ImGuiCol_PlotHistogram);
  case Drawing::Colour::accent:
    return ImGui::GetColorU32(accent());
  case Drawing::Colour::shade:
    return ImGui::GetColorU32(accent(0.16F));
  }
  return 0;
}

/// Where a drawing is in the window.
class Place {
public:
  Place(ImVec2 corner, float stretch) : corner_(corner), stretch_(stretch) {}

  void draw(const Drawing::Shape& shape, const Pictures& pictures) const {
    const ImU32 colour = colour_of(shape.colour);
    std::vector<ImVec2> points;
    for (const Eigen::Vector2f& point : shape.points)
      points.push_back({corner_.x + stretch_ * point.x(), corner_.y + scale() * point.y()});
    const auto count = static_cast<int>(points.size());
    switch (shape.kind) {
    case Kind::area:
      return list_.AddConvexPolyFilled(points.data(), count, colour);
    case Kind::line:
      return list_.AddPolyline(points.data(), count, colour, 0, scale());
    case Kind::diamond:
      return draw_diamond(points[0], colour, colour_of(shape.rim));
    case Kind::words:
      return list_.AddText({points[0].x, points[0].y - ImGui::GetFontSize() / 2.0F}, colour,
                           shape.words.c_str());
    case Kind::picture:
      return draw_cut(points, pictures.at(shape.picture), shape.picture->size());
    }
  }

private:
  void draw_diamond(const ImVec2& middle, ImU32 colour, ImU32 rim) const {
    const float half = scale() * static_cast<float>(Drawing::half_diamond);
    const ImVec2 top(middle.x, middle.y - half), right(middle.x + half, middle.y);
    const ImVec2 bottom(middle.x, middle.y + half), left(middle.x - half, middle.y);
    list_.AddQuadFilled(top, right, bottom, left, colour);
    list_.AddQuad(top, right, bottom, left, rim, 1.5F);
  }

  /// Fills the rectangle of the first two points, and shows what is between the two others.
  void draw_cut(const std::vector<ImVec2>& points, const gl::Picture& picture,
                const render::Size& size) const {
    const ImVec2 &low = points[0], &high = points[1];
    const float ratio = static_cast<float>(size.height) / static_cast<float>(size.width);
    list_.PushClipRect(points[2], points[3], true);
    draw_picture(list_, picture, low, high, (high.x - low.x) / (high.y - low.y) * ratio);
    list_.PopClipRect();
  }

  ImDrawList& list_ = *ImGui::GetWindowDrawList();
  const ImVec2 corner_;
  const float stretch_;
};

/// Of the latest item.
forms::Pointer pointer_in(const ImVec2& corner, float stretch) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool is_pointed_at = ImGui::IsItemHovered(), is_active = ImGui::IsItemActive();
  forms::Pointer pointer;
  if (is_pointed_at || is_active)
    pointer.at =
        Eigen::Vector2f((io.MousePos.x - corner.x) / stretch, (io.MousePos.y - corner.y) / scale())
            .cast<double>();
  pointer.is_pressed = ImGui::IsItemActivated() && ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  pointer.is_held = is_active && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  if (is_active && ImGui::IsMouseDown(ImGuiMouseButton_Middle))
    pointer.panned = static_cast<double>(io.MouseDelta.x / stretch);
  if (is_pointed_at) pointer.wheel = static_cast<double>(io.MouseWheel);
  pointer.has_control = io.KeyCtrl;
  return pointer;
}

} // namespace

forms::Pointer WindowDrawing::draw(std::string_view name, const Drawing& drawing) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(std::max(em(4.0F), ImGui::GetContentRegionAvail().x),
                    scale() * static_cast<float>(drawing.height));
  ImGui::InvisibleButton(std::string(name).c_str(), size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
  note_control(name, "");
  const float stretch = drawing.width > 0.0 ? size.x / static_cast<float>(drawing.width) : scale();
  forms::Pointer pointer;
  if (drawing.takes_pointer) pointer = pointer_in(corner, stretch);
  pointer.width = static_cast<double>(size.x / scale());
  follow_pictures(drawing);
  const Place place(corner, stretch);
  for (const Drawing::Shape& shape : drawing.shapes)
    place.draw(shape, pictures_);
  return pointer;
}

void WindowDrawing::follow_pictures(const Drawing& drawing) {
  for (const Drawing::Shape& shape : drawing.shapes)
    if (shape.picture) pictures_.try_emplace(shape.picture, *shape.picture);
  std::erase_if(pictures_, [&](const auto& one) {
    return std::ranges::find(drawing.shapes, one.first, &Drawing::Shape::picture) ==
           drawing.shapes.end();
  });
}

} // namespace nendo::viewer
