#include "viewer/theme.hpp"

#include <filesystem>
#include <initializer_list>

namespace nendo::viewer {
namespace {

constexpr float font_px = 15.0F; // on a screen of scale 1
constexpr float large_font_px = 25.0F;

/// Of Debian's packages fonts-inter and fonts-dejavu-core.
constexpr std::initializer_list<const char*> fonts{
    "/usr/share/fonts/opentype/inter/Inter-Regular.otf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
};

struct Palette {
  unsigned text, faint, border, control, window, accent, chart, warning;
  float window_opacity, frame; ///< frame: the opacity of a field over the window
};
constexpr Palette light{0x23282D, 0x5C656D, 0xC9CFD4, 0xFFFFFF, 0xFFFFFF,
                        0xB4532A, 0x34567A, 0xA8480F, 0.92F,    0.045F};
constexpr Palette dark{0xE3E6E9, 0x9AA3AB, 0x454B52, 0x33383E, 0x22262A,
                       0xE0794B, 0x8FB4DC, 0xF0A060, 0.92F,    0.10F};

ImVec4 colour(unsigned rgb, float opacity = 1.0F) {
  const auto part = [&](unsigned shift) {
    return static_cast<float>(rgb >> shift & 0xFFU) / 255.0F;
  };
  return {part(16), part(8), part(0), opacity};
}

Palette& palette() {
  static Palette now = light;
  return now;
}

float& scale_in_use() {
  static float now = 1.0F;
  return now;
}

void use_sizes(ImGuiStyle& style) {
  style.WindowRounding = 8.0F;
  style.PopupRounding = 6.0F;
  style.ChildRounding = 5.0F;
  style.FrameRounding = 5.0F;
  style.GrabRounding = 5.0F;
  style.ScrollbarRounding = 5.0F;
  style.ScrollbarSize = 10.0F;
  style.FrameBorderSize = 1.0F;
  style.WindowPadding = {12.0F, 10.0F};
  style.FramePadding = {8.0F, 4.0F};
  style.ItemSpacing = {6.0F, 6.0F};
  style.ItemInnerSpacing = {6.0F, 4.0F};
}

void use_colours(ImGuiStyle& style, const Palette& from) {
  const auto paint = [&](const ImVec4& one, std::initializer_list<int> items) {
    for (const int item : items)
      style.Colors[item] = one;
  };
  paint(colour(from.text), {ImGuiCol_Text});
  paint(colour(from.faint), {ImGuiCol_TextDisabled});
  paint(colour(from.border), {ImGuiCol_Border, ImGuiCol_Separator});
  paint(colour(from.control), {ImGuiCol_PopupBg, ImGuiCol_Button});
  paint(colour(from.window, from.window_opacity),
        {ImGuiCol_WindowBg, ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed});
  paint(colour(from.text, from.frame), {ImGuiCol_FrameBg, ImGuiCol_Header});
  paint(colour(from.accent, 0.25F),
        {ImGuiCol_ButtonHovered, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive,
         ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive});
  paint(colour(from.accent), {ImGuiCol_ButtonActive, ImGuiCol_CheckMark, ImGuiCol_SliderGrab,
                              ImGuiCol_SliderGrabActive, ImGuiCol_PlotLines});
  paint(colour(from.chart), {ImGuiCol_PlotHistogram});
  paint(colour(0x000000, 0.20F), {ImGuiCol_ModalWindowDimBg});
}

/// Scripts of which file names and names of wearers may be.
const ImWchar* glyphs() {
  static ImVector<ImWchar> ranges;
  if (!ranges.empty()) return ranges.Data;
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  constexpr ImWchar others[] = {0x0100, 0x017F, 0x2010, 0x2027, 0x2190, 0x2193, 0};
  ImFontGlyphRangesBuilder builder;
  builder.AddRanges(atlas.GetGlyphRangesDefault());
  builder.AddRanges(atlas.GetGlyphRangesCyrillic());
  builder.AddRanges(atlas.GetGlyphRangesVietnamese());
  builder.AddRanges(others);
  builder.BuildRanges(&ranges);
  return ranges.Data;
}

void use_font(float scale) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  for (const char* const file : fonts) {
    std::error_code error; // ImGui asserts that the file can be read
    if (!std::filesystem::is_regular_file(file, error)) continue;
    if (atlas.AddFontFromFileTTF(file, font_px * scale, nullptr, glyphs()) == nullptr) continue;
    atlas.AddFontFromFileTTF(file, large_font_px * scale);
    return;
  }
  for (const float size : {13.0F, 26.0F}) { // for which it is drawn, and twice as large
    ImFontConfig own;
    own.SizePixels = size * scale;
    atlas.AddFontDefault(&own);
  }
}

} // namespace

void use_theme(Theme theme, float scale) {
  palette() = theme == Theme::dark ? dark : light;
  scale_in_use() = scale;
  ImGuiStyle style;
  if (theme == Theme::dark) {
    ImGui::StyleColorsDark(&style);
  } else {
    ImGui::StyleColorsLight(&style);
  }
  use_sizes(style);
  use_colours(style, palette());
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
  use_font(scale);
  ImGui::GetIO().Fonts->Build(); // em() needs it before the first picture
}

ImFont* large_font() {
  return ImGui::GetIO().Fonts->Fonts[1];
}

float scale() {
  return scale_in_use();
}

bool is_dark() {
  return palette().text == dark.text;
}

ImVec4 accent(float opacity) {
  return colour(palette().accent, opacity);
}

ImVec4 warning() {
  return colour(palette().warning);
}

} // namespace nendo::viewer
