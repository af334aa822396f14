#include "viewer/panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "viewer/key_list.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {

using flow::Request;
using hand::Joint;

namespace {

constexpr std::array finger_names{"thumb", "index", "middle", "ring", "little"};
constexpr std::array kernels{deform::Wendland::c0, deform::Wendland::c2, deform::Wendland::c4,
                             deform::Wendland::c6};
constexpr double least_radius_m = 0.01;
constexpr double most_radius_m = 0.4;

constexpr std::array key_table{
    KeyLine{"g", "grab: the hands take hold"},
    KeyLine{"l", "let go; what is shaped stays"},
    KeyLine{"c", "commit: this shape becomes the rest shape"},
    KeyLine{"u", "undo the last commit"},
    KeyLine{"r", "redo what was undone"},
    KeyLine{"x", "reset: back to the model as it was loaded"},
    KeyLine{"t", "a take: record from this shape on, and end that"},
    KeyLine{"k", "keep the recording of what was just done (--keep-last)"},
    KeyLine{"s", "save the model as it is now"},
    KeyLine{"m, n", "the other mode, the next kernel"},
    KeyLine{"[, ]", "smaller radii, larger ones"},
    KeyLine{"Enter", "apply the mode, kernel and radii that are chosen"},
    KeyLine{"q", "quit; the shape is written"},
};

// How far two joints that follow each other are turned, degrees.
float bend_deg(const hand::HandPose& pose, Joint from, Joint to) {
  const Eigen::Matrix3d turn = pose[from].linear().transpose() * pose[to].linear();
  const double cosine = std::clamp((turn.trace() - 1.0) / 2.0, -1.0, 1.0);
  return static_cast<float>(to_degrees(std::acos(cosine)));
}

// Three joints a finger, from its root.
std::array<float, 15> bends_of(const hand::HandPose& pose) {
  std::array<float, 15> bends{};
  bends[0] = bend_deg(pose, Joint::wrist, Joint::thumb_metacarpal);
  bends[1] = bend_deg(pose, Joint::thumb_metacarpal, Joint::thumb_proximal);
  bends[2] = bend_deg(pose, Joint::thumb_proximal, Joint::thumb_distal);
  for (std::size_t finger = 1; finger < 5; ++finger) {
    const std::size_t metacarpal = index_of(Joint::index_metacarpal) + 5 * (finger - 1);
    for (std::size_t joint = 0; joint < 3; ++joint)
      bends[3 * finger + joint] = bend_deg(pose, static_cast<Joint>(metacarpal + joint),
                                           static_cast<Joint>(metacarpal + joint + 1));
  }
  return bends;
}

void chart(const char* name, const Strip& strip, const char* unit) {
  char words[64];
  std::snprintf(words, sizeof words, "most %.2f %s", static_cast<double>(strip.most()), unit);
  ImGui::PlotLines(name, strip.data(), strip.size(), strip.oldest(), words, 0.0F,
                   std::max(1.0F, strip.most()), ImVec2(200.0F, 44.0F));
}

} // namespace

float Strip::most() const noexcept {
  return *std::max_element(values_.begin(), values_.end());
}

void LiveWindow::Panel::follow(const flow::Frame& frame, double rate_hz) {
  if (frame.ticks_run == 0) return;
  const auto ms = [](HostClock::duration time) {
    return static_cast<float>(1e3 * to_seconds(time));
  };
  late_ms.add(std::max(0.0F, ms(frame.woke - frame.scheduled)));
  gap_ms.add(
      static_cast<float>(std::abs(static_cast<double>(ms(frame.since_last)) - 1e3 / rate_hz)));
  last_tick = frame.tick;
}

void LiveWindow::Panel::buttons(const flow::Frame& frame, const Gauges& gauges,
                                Commands& commands) {
  ImGui::TextUnformatted(frame.held ? "The hands hold the model." : "The hands have let go.");
  const auto ask = [&](const char* words, Request request) {
    if (ImGui::Button(words)) commands.emplace_back(request);
    ImGui::SameLine();
  };
  ask("Grab", Request::grab);
  ask("Let go", Request::let_go);
  ask("Commit", Request::commit);
  ask("Undo", Request::undo);
  ask("Redo", Request::redo);
  if (ImGui::Button("Reset")) reset_asked = true;
  if (ImGui::Button(gauges.recording ? "End the recording" : "Record"))
    commands.emplace_back(flow::SetRecording{!gauges.recording});
  ImGui::SameLine();
  if (ImGui::Button("Keep")) commands.emplace_back(flow::SaveRecording{});
  ImGui::SameLine();
  if (ImGui::Button("Save")) commands.emplace_back(flow::SaveShape{});
  if (!gauges.report.empty()) {
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + 290.0F);
    ImGui::TextUnformatted(gauges.report.c_str());
    ImGui::PopTextWrapPos();
  }
}

void LiveWindow::Panel::question(Commands& commands) {
  constexpr const char* title = "Back to the model as it was loaded?";
  if (std::exchange(reset_asked, false)) ImGui::OpenPopup(title);
  if (!begin_question(title)) return;
  ImGui::TextUnformatted("What has been shaped is lost, for undo begins anew.");
  const bool reset = ImGui::Button("Reset");
  ImGui::SameLine();
  const bool stay = ImGui::Button("Keep the shape") || pressed(GLFW_KEY_ESCAPE);
  if (reset) commands.emplace_back(flow::ResetModel{});
  if (reset || stay) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

void LiveWindow::Panel::settings(Commands& commands) {
  int mode = static_cast<int>(wanted.mode);
  ImGui::RadioButton("type1: pull", &mode, 0);
  ImGui::SameLine();
  ImGui::RadioButton("type2: strokes", &mode, 1);
  wanted.mode = static_cast<flow::Mode>(mode);
  if (ImGui::BeginCombo("kernel", std::string(deform::name_of(wanted.kernel)).c_str())) {
    for (const auto kernel : kernels)
      if (ImGui::Selectable(std::string(deform::name_of(kernel)).c_str(), kernel == wanted.kernel))
        wanted.kernel = kernel;
    ImGui::EndCombo();
  }
  ImGui::Checkbox("one radius for all fingers", &one_radius);
  for (std::size_t finger = 0; finger < (one_radius ? 1 : finger_names.size()); ++finger) {
    auto radius_cm = static_cast<float>(100.0 * wanted.radius_m[finger]);
    if (ImGui::SliderFloat(one_radius ? "radius" : finger_names[finger], &radius_cm,
                           static_cast<float>(100.0 * least_radius_m),
                           static_cast<float>(100.0 * most_radius_m), "%.1f cm"))
      wanted.radius_m[finger] =
          std::clamp(static_cast<double>(radius_cm) / 100, least_radius_m, most_radius_m);
  }
  if (one_radius) wanted.radius_m.fill(wanted.radius_m[0]);
  if (wanted == in_force) {
    ImGui::TextDisabled("as in force");
  } else if (ImGui::Button("Apply")) {
    commands.emplace_back(flow::ChangeSettings{wanted});
  } else {
    ImGui::SameLine();
    ImGui::TextDisabled("restarts the loop from this shape; undo begins anew");
  }
}

void LiveWindow::Panel::timing(const flow::Frame& frame, const Gauges& gauges) const {
  ImGui::Text("%g Hz wanted, %llu ticks, %llu missed", gauges.rate_hz,
              static_cast<unsigned long long>(frame.ticks_run),
              static_cast<unsigned long long>(frame.missed));
  chart("late", late_ms, "ms");
  chart("uneven", gap_ms, "ms");
  chart("picture", pictures_ms, "ms");
  if (gauges.restart_ms > 0.0) ImGui::Text("the last change took %.1f ms", gauges.restart_ms);
}

void LiveWindow::Panel::hands(const flow::Frame& frame, const Gauges& gauges) const {
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    const auto& hand = frame.hands[slot];
    if (!hand.present) continue;
    ImGui::Text("%s: %s", std::string(name_of(side)).c_str(), gauges.gloves[slot].c_str());
    ImGui::Text("%llu samples%s, %llu bad records, %llu lost",
                static_cast<unsigned long long>(hand.samples), hand.silent ? " (silent)" : "",
                static_cast<unsigned long long>(gauges.bad_records[slot]),
                static_cast<unsigned long long>(gauges.lost[slot]));
    const auto bends = bends_of(hand.pose);
    ImGui::PushID(static_cast<int>(slot));
    ImGui::PlotHistogram("joints", bends.data(), static_cast<int>(bends.size()), 0,
                         "thumb to little, degrees", 0.0F, 110.0F, ImVec2(200.0F, 60.0F));
    ImGui::PopID();
  }
}

void LiveWindow::Panel::settings_keys(Commands& commands) {
  if (pressed(GLFW_KEY_M))
    wanted.mode = wanted.mode == flow::Mode::type1 ? flow::Mode::type2 : flow::Mode::type1;
  if (pressed(GLFW_KEY_N)) {
    const auto at = std::find(kernels.begin(), kernels.end(), wanted.kernel) - kernels.begin();
    wanted.kernel = kernels[(static_cast<std::size_t>(at) + 1) % kernels.size()];
  }
  constexpr double larger = 1.1;
  for (const auto& [key, factor] :
       {std::pair{GLFW_KEY_LEFT_BRACKET, 1.0 / larger}, {GLFW_KEY_RIGHT_BRACKET, larger}})
    if (pressed(key, true))
      for (double& radius_m : wanted.radius_m)
        radius_m = std::clamp(factor * radius_m, least_radius_m, most_radius_m);
  if (pressed(GLFW_KEY_ENTER) && !(wanted == in_force))
    commands.emplace_back(flow::ChangeSettings{wanted});
}

void LiveWindow::Panel::keys(const Gauges& gauges, Commands& commands) {
  if (!takes_keys()) return;
  for (const auto& [key, request] : {std::pair{GLFW_KEY_G, Request::grab},
                                     {GLFW_KEY_L, Request::let_go},
                                     {GLFW_KEY_C, Request::commit},
                                     {GLFW_KEY_U, Request::undo},
                                     {GLFW_KEY_R, Request::redo}})
    if (pressed(key)) commands.emplace_back(request);
  if (pressed(GLFW_KEY_X)) reset_asked = true;
  if (pressed(GLFW_KEY_T)) commands.emplace_back(flow::SetRecording{!gauges.recording});
  if (pressed(GLFW_KEY_K)) commands.emplace_back(flow::SaveRecording{});
  if (pressed(GLFW_KEY_S)) commands.emplace_back(flow::SaveShape{});
  settings_keys(commands);
  if (pressed(GLFW_KEY_Q)) commands.emplace_back(flow::EndRun{});
  if (pressed(GLFW_KEY_SLASH)) keys_shown = !keys_shown;
  if (keys_shown)
    draw_key_list(key_table,
                  "right drag on a hand moves it, with shift turns it, with the wheel\n"
                  "pushes and pulls it",
                  keys_shown);
}

void LiveWindow::draw_panel(const flow::Frame& frame, const Gauges& gauges, Commands& commands) {
  ImGui::SetNextWindowPos(ImVec2(10.0F, 10.0F), ImGuiCond_FirstUseEver);
  ImGui::Begin("Nendo", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::Text("%s   (? for keys)", gauges.model.c_str());
  panel_->buttons(frame, gauges, commands);
  if (ImGui::CollapsingHeader("Shaping", ImGuiTreeNodeFlags_DefaultOpen))
    panel_->settings(commands);
  if (ImGui::CollapsingHeader("Timing", ImGuiTreeNodeFlags_DefaultOpen))
    panel_->timing(frame, gauges);
  if (ImGui::CollapsingHeader("Gloves", ImGuiTreeNodeFlags_DefaultOpen))
    panel_->hands(frame, gauges);
  ImGui::End();
  panel_->question(commands);
  window_->follow_part_keys();
  panel_->keys(gauges, commands);
}

} // namespace nendo::viewer
