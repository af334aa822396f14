#include "viewer/controls.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/files.hpp>

#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

constexpr float label_em = 6.4F;

std::vector<Control>& noted() {
  static std::vector<Control> all;
  return all;
}

constexpr ImU32 chosen_text = IM_COL32(255, 255, 255, 255);

/// A button, in the accent's colour if it is chosen.
bool draw_button(std::string_view name, ImVec2 size, bool is_chosen) {
  if (is_chosen) {
    ImGui::PushStyleColor(ImGuiCol_Button, accent());
    ImGui::PushStyleColor(ImGuiCol_Text, chosen_text);
  }
  const bool pressed = ImGui::Button(std::string(name).c_str(), size);
  if (is_chosen) ImGui::PopStyleColor(2);
  note_control(name, name, 2.0F);
  return pressed;
}

std::string& shown_tooltip() {
  static std::string text;
  return text;
}

float width_of(std::string_view text) {
  return ImGui::CalcTextSize(text.data(), text.data() + text.size()).x;
}

/// The part of the rectangle in which ImGui draws now.
void clip(Control& control) {
  const ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 low = list.GetClipRectMin(), high = list.GetClipRectMax();
  control.min = control.min.cwiseMax(Eigen::Vector2f(low.x, low.y));
  control.max = control.max.cwiseMin(Eigen::Vector2f(high.x, high.y));
}

/// Writes the label, and leaves the rest of the line to a field.
void label(std::string_view text) {
  const float left = ImGui::GetCursorPosX();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  note_control("label " + std::string(text), text, width_of(text) - em(label_em - 0.2F));
  ImGui::SameLine();
  ImGui::SetCursorPosX(left + em(label_em));
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
}

/// Fills as much of the field as the value is of the range, below the number.
void draw_share(float share) {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const float width = std::clamp(share, 0.0F, 1.0F) * ImGui::CalcItemWidth();
  ImGui::GetWindowDrawList()->AddRectFilled(low, {low.x + width, low.y + ImGui::GetFrameHeight()},
                                            ImGui::GetColorU32(accent(0.22F)),
                                            ImGui::GetStyle().FrameRounding);
}

} // namespace

std::span<const Control> controls() noexcept {
  return noted();
}

void forget_controls() noexcept {
  noted().clear();
  shown_tooltip().clear();
}

const std::string& tooltip() noexcept {
  return shown_tooltip();
}

void show_text(std::string_view text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  shown_tooltip() = text;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(em(24.0F));
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void write_controls() {
  static const char* const file = std::getenv("NENDO_CONTROLS");
  static std::string before;
  if (file == nullptr) return;
  std::string lines;
  for (const Control& control : controls()) {
    char numbers[96];
    std::snprintf(numbers, sizeof numbers, "%.0f %.0f %.0f %.0f %d ",
                  static_cast<double>(control.min.x()), static_cast<double>(control.min.y()),
                  static_cast<double>(control.max.x()), static_cast<double>(control.max.y()),
                  control.is_possible ? 1 : 0);
    lines += numbers + control.name + '\n';
  }
  if (lines != before) static_cast<void>(replace_file(file, lines));
  before = std::move(lines);
}

void note_control(std::string_view name, std::string_view text, float around) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  Control control{std::string(name), {low.x, low.y}, {high.x, high.y}};
  constexpr float rounding_px = 0.5F;
  const float right = ImGui::GetWindowDrawList()->GetClipRectMax().x;
  control.is_cut =
      width_of(text) + around > high.x - low.x + rounding_px || high.x > right + rounding_px;
  clip(control);
  if ((control.min.array() < control.max.array()).all()) noted().push_back(std::move(control));
}

bool button(std::string_view name, float width, bool is_possible, bool is_chosen) {
  ImGui::BeginDisabled(!is_possible);
  const bool pressed = draw_button(name, ImVec2(width, 0.0F), is_chosen);
  ImGui::EndDisabled();
  if (!noted().empty()) noted().back().is_possible = is_possible;
  return pressed && is_possible;
}

bool check(std::string_view name, bool& value) {
  const bool changed = ImGui::Checkbox(std::string(name).c_str(), &value);
  note_control(name, name, ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x);
  return changed;
}

bool section(std::string_view name, std::string_view help, bool is_open_at_first) {
  const bool is_open = ImGui::CollapsingHeader(
      std::string(name).c_str(), is_open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  note_control(name, name, ImGui::GetFrameHeight());
  show_text(help);
  return is_open;
}

bool picture_button(std::string_view name, const forms::LinePicture* picture, float width,
                    bool is_chosen) {
  if (picture == nullptr) return button(name, width, true, is_chosen);
  const float high = em(2.2F);
  ImGui::PushStyleVar(ImGuiStyleVar_ButtonTextAlign, ImVec2(0.5F, 1.0F));
  const bool pressed = draw_button(name, ImVec2(width, ImGui::GetFrameHeight() + high), is_chosen);
  ImGui::PopStyleVar();
  const ImVec2 pad = ImGui::GetStyle().FramePadding;
  const ImVec2 low = ImGui::GetItemRectMin(), end = ImGui::GetItemRectMax();
  const ImU32 colour = is_chosen ? chosen_text : ImGui::GetColorU32(ImGuiCol_Text);
  std::vector<ImVec2> points;
  for (const auto& line : *picture) {
    points.clear();
    for (const Eigen::Vector2d& place : line)
      points.push_back(
          {low.x + pad.x + static_cast<float>(place.x()) * (end.x - low.x - 2.0F * pad.x),
           low.y + pad.y + static_cast<float>(1.0 - place.y()) * high});
    ImGui::GetWindowDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()), colour,
                                            0, 1.2F * scale());
  }
  return pressed;
}

bool bar_field(std::string_view name, float& value, float min, float max, const char* format,
               float width) {
  ImGui::SetNextItemWidth(width > 0.0F ? width : ImGui::GetContentRegionAvail().x);
  draw_share((value - min) / (max - min));
  const float before = value;
  ImGui::PushID(name.data(), name.data() + name.size());
  ImGui::DragFloat("##number", &value, (max - min) / 200.0F, min, max, format,
                   ImGuiSliderFlags_AlwaysClamp);
  ImGui::PopID();
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && io.KeyCtrl && io.MouseWheel != 0.0F)
    value = std::clamp(value + io.MouseWheel * (max - min) / 50.0F, min, max);
  note_control(name, "");
  return value != before;
}

bool number_field(std::string_view text, float& value, float min, float max, const char* format) {
  ImGui::BeginGroup();
  label(text);
  const bool changed = bar_field(text, value, min, max, format, 0.0F);
  ImGui::EndGroup();
  return changed;
}

bool text_field(std::string_view name, std::span<char> text) {
  label(name);
  ImGui::PushID(name.data(), name.data() + name.size());
  const bool changed = ImGui::InputText("##text", text.data(), text.size());
  ImGui::PopID();
  note_control(name, "");
  return changed;
}

bool choice_field(std::string_view text, std::span<const std::string_view> names,
                  std::size_t& chosen) {
  ImGui::BeginGroup();
  label(text);
  bool changed = false;
  const std::string now(names[chosen]);
  ImGui::PushID(text.data(), text.data() + text.size());
  const bool is_open = ImGui::BeginCombo("##choice", now.c_str());
  if (is_open) {
    for (std::size_t at = 0; at < names.size(); ++at) {
      const bool taken = ImGui::Selectable(std::string(names[at]).c_str(), at == chosen);
      note_control("choice " + std::string(names[at]), names[at]);
      if (!taken) continue;
      changed = at != chosen;
      chosen = at;
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
  if (!is_open) note_control(text, now, ImGui::GetFrameHeight());
  ImGui::EndGroup();
  return changed;
}

float share_of_line(std::size_t count) {
  const auto number = static_cast<float>(count);
  const float space = ImGui::GetStyle().ItemSpacing.x;
  return (ImGui::GetContentRegionAvail().x - (number - 1.0F) * space) / number;
}

} // namespace nendo::viewer
