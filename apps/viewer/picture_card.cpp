#include "viewer/picture_card.hpp"

#include <string>
#include <type_traits>

#include "viewer/controls.hpp"
#include "viewer/theme.hpp"
#include <imgui.h>

namespace nendo::viewer {
namespace {

/// ImGui's name of a texture is a pointer, and since version 1.91.4 a number.
template <class Id = ImTextureID>
Id imgui_texture(unsigned texture) {
  if constexpr (std::is_pointer_v<Id>)
    return reinterpret_cast<Id>(static_cast<std::uintptr_t>(texture));
  else
    return static_cast<Id>(texture);
}

} // namespace

void draw_picture(ImDrawList& list, const gl::Picture& picture, const ImVec2& low,
                  const ImVec2& high, float part, float rounding) {
  const float beside = (1.0F - part) / 2.0F;
  list.AddImageRounded(imgui_texture(picture.texture()), low, high, {beside, 0.0F},
                       {1.0F - beside, 1.0F}, IM_COL32_WHITE, rounding);
}

bool picture_card(std::string_view name, const gl::Picture* picture, float ratio, float width,
                  bool is_chosen) {
  const std::string text(name);
  const float gap = em(0.35F), height = width / ratio;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 picture_high{low.x + width, low.y + height};
  const ImVec2 high{picture_high.x, picture_high.y + ImGui::GetFontSize() + 2.0F * gap};
  ImGui::PushID(text.c_str());
  const bool pressed = ImGui::InvisibleButton("##picture", {width, high.y - low.y});
  ImGui::PopID();
  const bool is_pointed_at = ImGui::IsItemHovered();
  const ImGuiStyle& style = ImGui::GetStyle();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float round = style.FrameRounding;
  const auto colour = [&](ImGuiCol one) { return ImGui::GetColorU32(style.Colors[one]); };
  list.AddRectFilled(low, high, colour(is_pointed_at ? ImGuiCol_HeaderHovered : ImGuiCol_FrameBg),
                     round);
  if (picture != nullptr) draw_picture(list, *picture, low, picture_high, 1.0F, round);
  const bool is_marked = is_chosen || is_pointed_at;
  list.AddRect(low, high, is_marked ? ImGui::GetColorU32(accent()) : colour(ImGuiCol_Border), round,
               0, (is_chosen ? 2.5F : 1.0F) * scale());
  list.PushClipRect(low, high, true);
  const float text_width = ImGui::CalcTextSize(text.c_str()).x;
  list.AddText({low.x + (width - text_width) / 2.0F, picture_high.y + gap}, colour(ImGuiCol_Text),
               text.c_str());
  list.PopClipRect();
  note_control(name, name, 2.0F);
  return pressed;
}

} // namespace nendo::viewer
