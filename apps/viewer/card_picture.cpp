#include "viewer/card_picture.hpp"

#include <string>
#include <type_traits>

#include "viewer/controls.hpp"
#include "viewer/theme.hpp"
#include <GL/gl.h>
#include <imgui.h>

namespace nendo::viewer {
namespace {

constexpr GLint clamp_to_edge = 0x812F; // newer than Windows' header, and so than GL/gl.h

/// ImGui's name of a texture is a pointer, and since version 1.91.4 a number.
template <class Id = ImTextureID>
Id imgui_texture(unsigned texture) {
  if constexpr (std::is_pointer_v<Id>)
    return reinterpret_cast<Id>(static_cast<std::uintptr_t>(texture));
  else
    return static_cast<Id>(texture);
}

} // namespace

CardPicture::CardPicture(const render::Image& image) {
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  for (const int filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(filter), GL_LINEAR);
  for (const int wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(wrap), clamp_to_edge);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, image.size().width, image.size().height, 0, GL_RGB,
               GL_UNSIGNED_BYTE, image.pixels().data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

CardPicture::~CardPicture() {
  glDeleteTextures(1, &texture_);
}

void draw_picture(ImDrawList& list, const CardPicture& picture, const ImVec2& low,
                  const ImVec2& high, float part, float rounding) {
  const float beside = (1.0F - part) / 2.0F;
  list.AddImageRounded(imgui_texture(picture.texture()), low, high, {beside, 0.0F},
                       {1.0F - beside, 1.0F}, IM_COL32_WHITE, rounding);
}

bool picture_card(std::string_view name, const CardPicture* picture, float ratio, float width,
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
