#include "viewer/status_bar.hpp"

#include <cstdio>
#include <utility>
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
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  if (!message.empty()) {
    ImGui::TextColored(warning(), "%s", message.c_str());
    note_control("message", message);
  } else if (frame.ticks_run > 0) {
    bool is_first = true;
    for (const auto& [text, help] : items(frame, gauges)) {
      if (!std::exchange(is_first, false)) ImGui::SameLine(0.0F, em(1.6F));
      ImGui::TextUnformatted(text.c_str());
      note_control("status " + text, text);
      show_text(help);
    }
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

} // namespace nendo::viewer
