#include "viewer/panel_style.hpp"

#include <imgui.h>

namespace nendo::viewer {
namespace {

ImVec4 page_colour(unsigned rgb, float opacity = 1.0F) {
  const auto part = [&](unsigned shift) {
    return static_cast<float>(rgb >> shift & 0xFFU) / 255.0F;
  };
  return {part(16), part(8), part(0), opacity};
}

void use_shapes(ImGuiStyle& style) {
  style.WindowRounding = 10.0F;
  style.PopupRounding = 8.0F;
  style.FrameRounding = 5.0F;
  style.GrabRounding = 5.0F;
  style.ScrollbarRounding = 5.0F;
  style.ScrollbarSize = 10.0F;
  style.FrameBorderSize = 1.0F;
  style.WindowPadding = {12.0F, 10.0F};
  style.FramePadding = {7.0F, 3.0F};
  style.ItemSpacing = {6.0F, 5.0F};
}

} // namespace

void use_page_style() {
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  use_shapes(style);
  const ImVec4 ink = page_colour(0x23282D); // these are page.css's
  const ImVec4 soft = page_colour(0x5C656D);
  const ImVec4 edge = page_colour(0xC9CFD4);
  const ImVec4 accent = page_colour(0xB4532A);
  const ImVec4 pale_accent = page_colour(0xB4532A, 0.25F);
  const ImVec4 paper = page_colour(0xFFFFFF);
  const ImVec4 faint = page_colour(0x000000, 0.045F);
  auto& colours = style.Colors;
  colours[ImGuiCol_Text] = ink;
  colours[ImGuiCol_TextDisabled] = soft;
  colours[ImGuiCol_WindowBg] = page_colour(0xFFFFFF, 0.90F);
  colours[ImGuiCol_PopupBg] = paper;
  colours[ImGuiCol_Border] = edge;
  for (const int title : {ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed})
    colours[title] = page_colour(0xFFFFFF, 0.90F);
  colours[ImGuiCol_Button] = paper;
  colours[ImGuiCol_ButtonHovered] = pale_accent;
  colours[ImGuiCol_ButtonActive] = accent;
  colours[ImGuiCol_FrameBg] = faint;
  colours[ImGuiCol_FrameBgHovered] = pale_accent;
  colours[ImGuiCol_FrameBgActive] = pale_accent;
  colours[ImGuiCol_CheckMark] = accent;
  colours[ImGuiCol_SliderGrab] = accent;
  colours[ImGuiCol_SliderGrabActive] = accent;
  colours[ImGuiCol_Header] = faint;
  colours[ImGuiCol_HeaderHovered] = pale_accent;
  colours[ImGuiCol_HeaderActive] = pale_accent;
  colours[ImGuiCol_PlotLines] = accent;
  colours[ImGuiCol_PlotHistogram] = page_colour(0x34567A);
  colours[ImGuiCol_ModalWindowDimBg] = page_colour(0x000000, 0.20F);
}

} // namespace nendo::viewer
