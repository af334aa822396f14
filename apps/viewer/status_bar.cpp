#include "viewer/status_bar.hpp"

#include <cstdio>
#include <vector>

#include <imgui.h>

#include "viewer/controls.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

std::string in_figures(double number, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, number);
  return text;
}

std::string thousands(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

/// A silent glove and a lost tracker, or how old the newest sample is.
std::string state_of(const flow::HandFrame& hand, HostTime woke) {
  if (hand.silent) return "silent";
  if (hand.lost) return "tracker lost";
  return in_figures(1e3 * to_seconds(woke - hand.newest_sample), 0) + " ms";
}

std::vector<std::string> items(const flow::Frame& frame, const Gauges& gauges) {
  std::vector<std::string> all{frame.held ? "holds the model" : "holds nothing",
                               thousands(gauges.vertices) + " vertices"};
  if (frame.clay.is_clay && frame.clay.first_volume > 0.0) {
    const double units = frame.units_per_metre;
    all.push_back(in_figures(1e6 * frame.clay.volume / (units * units * units), 1) + " cm3");
  }
  all.push_back(in_figures(gauges.rate_hz, 0) + " Hz, " + thousands(frame.missed) + " missed");
  for (const Side side : {Side::left, Side::right}) {
    const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
    if (hand.present) all.push_back(std::string(name_of(side)) + " " + state_of(hand, frame.woke));
  }
  return all;
}

} // namespace

float status_bar_height() {
  return em(1.8F);
}

void draw_status_bar(const flow::Frame& frame, const Gauges& gauges, const std::string& message) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float high = status_bar_height();
  ImGui::SetNextWindowPos(ImVec2(0.0F, all.y - high));
  ImGui::SetNextWindowSize(ImVec2(all.x, high));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(0.8F), em(0.4F)));
  ImGui::Begin("status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoNav);
  if (!message.empty()) {
    ImGui::TextColored(warning(), "%s", message.c_str());
    note_control("message", message);
  } else if (frame.ticks_run > 0) {
    bool is_first = true;
    for (const std::string& item : items(frame, gauges)) {
      if (!is_first) ImGui::SameLine(0.0F, em(1.6F));
      is_first = false;
      ImGui::TextUnformatted(item.c_str());
      note_control("status " + item, item);
    }
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

} // namespace nendo::viewer
