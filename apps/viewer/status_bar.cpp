#include "viewer/status_bar.hpp"

#include <cstdio>
#include <vector>

#include <imgui.h>

#include <nendo/base/figures.hpp>

#include "viewer/controls.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

std::string in_figures(double number, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, number);
  return text;
}

/// A silent glove and a lost tracker, or how old the newest sample is.
std::string state_of(const flow::HandFrame& hand, HostTime woke) {
  if (hand.silent) return "silent";
  if (hand.lost) return "tracker lost";
  return in_figures(1e3 * to_seconds(woke - hand.newest_sample), 0) + " ms";
}

std::string counted(std::uint64_t number) {
  return thousands(static_cast<std::int64_t>(number));
}

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

struct Item {
  std::string text;
  const char* help;
};

std::vector<Item> items(const flow::Frame& frame, const Gauges& gauges) {
  std::vector<Item> all{{frame.held ? "holds the model" : "holds nothing",
                         "Whether the hands hold the model: g grabs it, l releases it."},
                        {counted(gauges.vertices) + " vertices",
                         "Of the model; e makes them about four times as many."}};
  if (frame.clay.is_clay && frame.clay.first_volume > 0.0)
    all.push_back({volume_text(frame, frame.clay.volume), "The volume of the clay."});
  all.push_back({in_figures(gauges.rate_hz, 0) + " Hz, " + counted(frame.missed) + " missed",
                 "The rate of the loop, and how many of its deadlines were missed."});
  for (const Side side : {Side::left, Side::right}) {
    const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
    if (hand.present)
      all.push_back({std::string(name_of(side)) + " " + state_of(hand, frame.woke),
                     "How old the newest sample of this hand is, or that its glove is silent."});
  }
  return all;
}

} // namespace

std::string volume_text(const flow::Frame& frame, double volume) {
  const double units = frame.units_per_metre;
  return in_figures(1e6 * volume / (units * units * units), 1) + " cm3";
}

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
    for (const auto& [text, help] : items(frame, gauges)) {
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
