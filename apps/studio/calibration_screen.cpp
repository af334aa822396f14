#include "studio/calibration_screen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <imgui.h>

#include "gloves/screen_text.hpp"
#include "viewer/controls.hpp"
#include "viewer/pointing.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::studio {

using viewer::em;
using viewer::gap_em;

namespace {

constexpr float width_em = 21.0F;

int covered_px() {
  return static_cast<int>(em(gap_em + width_em));
}

/// The pixel of a place about which the camera turns, and which so is before it.
ImVec2 pixel(const viewer::SceneWindow& window, const Eigen::Vector3d& place_m) {
  const auto at = viewer::pixel_of(window.camera(), place_m, window.scene_size())
                      .value_or(Eigen::Vector2d::Zero());
  return {static_cast<float>(at.x()), static_cast<float>(at.y())};
}

void centred_words(const viewer::SceneWindow& window, const Eigen::Vector3d& place_m,
                   const char* words) {
  const ImVec2 at = pixel(window, place_m);
  const float width = ImGui::CalcTextSize(words).x;
  ImGui::GetBackgroundDrawList()->AddText({at.x - width / 2.0F, at.y}, IM_COL32(45, 50, 56, 255),
                                          words);
}

} // namespace

CalibrationScreen::CalibrationScreen(driver::Glove& glove, calibrate::CalibrationRequest request,
                                     bool fresh)
    : course_(glove, std::move(request), fresh), painter_(course_.side()) {
  camera_.view = view_of(hand::PoseId::fist, course_.side());
}

void CalibrationScreen::look_by(viewer::SceneWindow& window) {
  const HostTime now = HostClock::now();
  const double elapsed_s = drawn_ == HostTime{} ? 1.0 : to_seconds(now - drawn_);
  drawn_ = now;
  const render::Size size = window.scene_size();
  const double free_width = std::max(1, size.width - covered_px());
  turn_towards(camera_, course_.picture().view, elapsed_s);
  window.leave_left(covered_px());
  window.leave_below(0);
  window.look_by(camera_for(camera_.view, course_.picture().width_m, free_width / size.height));
}

void CalibrationScreen::draw_hands(viewer::SceneWindow& window) {
  for (const ShownHand& hand : course_.picture().hands)
    for (render::Surface& surface : painter_.draw(hand))
      window.add(std::move(surface));
  for (render::Surface& balls : painter_.balls(course_.picture().joints))
    window.add(std::move(balls));
  if (render::Surface surface = arrows(course_.picture().ways); !surface.is_empty())
    window.add(std::move(surface));
}

void CalibrationScreen::draw_panel(const viewer::SceneWindow& window) {
  const float gap = em(gap_em), top = window.above_px() + gap;
  const float high = ImGui::GetIO().DisplaySize.y - top - gap;
  viewer::begin_pane((course_.title() + "###calibration").c_str(), {gap, top}, {0.0F, 0.0F},
                     {em(width_em), std::max(em(3.0F), high)},
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoNavInputs);
  course_.describe(form_);
  ImGui::End();
  if (!viewer::takes_keys()) return;
  for (const calibrate::GuideActionRow& row : calibrate::guide_actions())
    if (viewer::pressed(row.key == ' ' ? ' ' : row.key - 'a' + 'A')) // GLFW's numbers
      course_.press(row.key);
  if (viewer::pressed('Q')) course_.press('q');
}

void CalibrationScreen::draw_words(const viewer::SceneWindow& window) const {
  const CourseWords& words = course_.picture().words;
  const float left = static_cast<float>(covered_px());
  const float free_width = ImGui::GetIO().DisplaySize.x - left;
  const float width = std::min(free_width - 2.0F * em(gap_em), em(52.0F));
  viewer::begin_pane("banner", {left + free_width / 2.0F, window.above_px() + em(gap_em)},
                     {0.5F, 0.0F}, {width, 4096.0F},
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                         ImGuiWindowFlags_NoNav);
  ImGui::PushFont(viewer::large_font());
  viewer::WindowForm form;
  form.text(words.instruction);
  form.text(words.state, words.warns ? Form::Tone::warning : Form::Tone::faint);
  ImGui::PopFont();
  ImGui::End();
}

/// What the two hands are, and numbers for the joint under the mouse.
void CalibrationScreen::draw_captions(const viewer::SceneWindow& window) const {
  const CoursePicture& picture = course_.picture();
  const Eigen::Vector3d low(0.0, -0.062, 0.0);
  centred_words(window, low - picture.aside_m, "how sure each joint is");
  centred_words(window, low + picture.aside_m, "your hand, calibrated");
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  const Eigen::Vector2d mouse(static_cast<double>(io.MousePos.x),
                              static_cast<double>(io.MousePos.y));
  const JointMark* const mark =
      mark_at(mouse, window.camera(), window.scene_size(), picture.joints);
  if (mark == nullptr) return;
  std::string text = std::string(calibrate::in_words(mark->sensor)) + ": " +
                     std::string(in_words(mark->certainty));
  const hand::SensorFit& fit = course_.finished()->fit.sensors[index_of(mark->sensor)];
  if (mark->certainty != calibrate::Certainty::estimated)
    text += ". Sure to " + gloves::fixed(to_degrees(fit.deviation_rad), 1) +
            " degrees; the poses are " + gloves::fixed(to_degrees(fit.residual_rad), 1) +
            " degrees off.";
  ImGui::SetTooltip("%s", text.c_str());
}

/// The ring about the wrist: while joints show their ranges, how many have; and then, how long the
/// hand has been still.
void CalibrationScreen::draw_ring(const viewer::SceneWindow& window) const {
  const float share = static_cast<float>(*course_.picture().ring);
  const ImVec2 middle = pixel(window, Eigen::Vector3d::Zero());
  const ImVec2 edge = pixel(window, {0.0, 0.058, 0.0});
  const float radius = std::hypot(edge.x - middle.x, edge.y - middle.y), width = radius / 5.0F;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  constexpr int segments = 96;
  list.AddCircle(middle, radius, IM_COL32(90, 98, 106, 70), segments, width);
  if (share <= 0.0F) return;
  constexpr auto turn = 2.0F * std::numbers::pi_v<float>;
  const ImU32 colour =
      course_.picture().warns ? ImGui::GetColorU32(viewer::warning()) : viewer::success_colour();
  if (share >= 1.0F) return list.AddCircle(middle, radius, colour, segments, width);
  list.PathArcTo(middle, radius, -turn / 4.0F, -turn / 4.0F + share * turn, segments);
  list.PathStroke(colour, 0, width);
}

std::optional<Result<CalibrationOutcome>> CalibrationScreen::show(viewer::SceneWindow& window) {
  course_.update();
  look_by(window);
  if (window.has_model()) window.clear_model();
  window.begin_picture({});
  draw_hands(window);
  draw_panel(window);
  draw_words(window);
  if (course_.picture().ring) draw_ring(window);
  if (!course_.picture().joints.empty()) draw_captions(window);
  window.end_picture();
  return course_.take_outcome();
}

} // namespace nendo::studio
