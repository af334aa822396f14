#include "viewer/status_bar.hpp"

#include <imgui.h>

#include "forms/run_status.hpp"
#include "viewer/controls.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

float width_of(const std::string& text) {
  return ImGui::CalcTextSize(text.c_str()).x;
}

/// Returns the text, without its middle if it is wider than that.
std::string fitting(const std::string& text, float width) {
  std::string shown = text;
  for (std::size_t half = text.size() / 2; half > 0 && width_of(shown) > width; --half)
    shown = text.substr(0, half) + "..." + text.substr(text.size() - half);
  return shown;
}

} // namespace

float status_bar_height() {
  return em(1.8F);
}

void draw_status_bar(const flow::Frame& frame, const Gauges& gauges, const std::string& message,
                     bool is_error) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float high = status_bar_height();
  ImGui::SetNextWindowPos(ImVec2(0.0F, all.y - high));
  ImGui::SetNextWindowSize(ImVec2(all.x, high));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(0.8F), em(0.4F)));
  ImGui::Begin("status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  const float left = ImGui::GetCursorPosX(), right = all.x - left, gap = em(1.6F);
  const std::string shown = fitting(message, right - left);
  const float begin = right - width_of(shown);
  float free_from = left;
  if (frame.ticks_run > 0)
    for (const auto& [text, help] : forms::status_items(frame, gauges.rate_hz, gauges.vertices)) {
      const float end = free_from + width_of(text);
      if (end > (shown.empty() ? right : begin - gap)) break;
      if (free_from > left) ImGui::SameLine(free_from);
      ImGui::TextUnformatted(text.c_str());
      note_control("status " + text, text);
      show_text(help);
      free_from = end + gap;
    }
  if (!shown.empty()) {
    if (free_from > left) ImGui::SameLine();
    ImGui::SetCursorPosX(begin);
    ImGui::TextColored(is_error ? warning() : ImGui::GetStyle().Colors[ImGuiCol_Text], "%s",
                       shown.c_str());
    note_control("message", shown);
    show_text(message);
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

} // namespace nendo::viewer
