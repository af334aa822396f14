// The panel, the words and the ring of a calibration's window.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <string_view>

#include <imgui.h>

#include "gloves/screen_text.hpp"
#include "studio/calibration_screen.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/pointing.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::studio {

using calibrate::CalibrationKind;
using calibrate::Certainty;
using calibrate::GuideAction;
using calibrate::GuideNotice;
using viewer::button;
using viewer::em;
using viewer::gap_em;

namespace {

constexpr float width_em = 21.0F;

ImVec4 success() {
  return viewer::is_dark() ? ImVec4(0.45F, 0.80F, 0.50F, 1.0F) : ImVec4(0.10F, 0.48F, 0.18F, 1.0F);
}

void wrapped(std::string_view text) {
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
}

void wrapped(std::string_view text, const ImVec4& colour) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  wrapped(text);
  ImGui::PopStyleColor();
}

void faint(std::string_view text) {
  wrapped(text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
}

/// A button that is the next thing to press.
bool main_button(std::string_view name, bool is_possible = true) {
  return button(name, ImGui::GetContentRegionAvail().x, is_possible, true);
}

/// Continues the line if the next button fits into it.
void flow(std::string_view next) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width =
      ImGui::CalcTextSize(next.data(), next.data() + next.size()).x + 2.0F * style.FramePadding.x;
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= right) ImGui::SameLine();
}

std::string key_text(char key) {
  return key == ' ' ? "SPACE" : std::string(1, key);
}

std::string notice_text(const GuideNotice& notice) {
  switch (notice.kind) {
  case GuideNotice::Kind::none:
    break;
  case GuideNotice::Kind::left_out:
    return notice.text + " Start again uses all sensors.";
  case GuideNotice::Kind::will_restart:
    return "Start again, pressed once more, forgets every pose.";
  case GuideNotice::Kind::unfitted:
    return notice.text + " Take the pose again, or start again.";
  }
  return {};
}

struct KindRow {
  CalibrationKind kind;
  std::string_view name;
  std::string_view about;
};
constexpr std::array kinds{
    KindRow{CalibrationKind::quick, "Quick: about a minute",
            "Flat hand and fist. Enough to begin with; fingers are exact to some 3 degrees, the "
            "thumb and spreading to less."},
    KindRow{CalibrationKind::full, "Full: about four minutes",
            "34 poses. All joints are exact to some 2 degrees."},
    KindRow{
        CalibrationKind::touch_up, "Touch up: half a minute",
        "Six poses, after the glove was put on again. Corrects where its sensors have slipped."},
};

std::string_view name_of(Certainty certainty) {
  switch (certainty) {
  case Certainty::sure:
    return "sure";
  case Certainty::less_sure:
    return "less sure";
  case Certainty::average:
    return "as on an average hand";
  case Certainty::estimated:
    break;
  }
  return "stuck, estimated";
}

ImVec4 screen_colour(Certainty certainty) {
  const auto encoded = [](float linear) { return std::pow(linear, 1.0F / 2.2F); };
  const Eigen::Vector3f colour = colour_of(certainty);
  return {encoded(colour.x()), encoded(colour.y()), encoded(colour.z()), 1.0F};
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

int CalibrationScreen::covered_px() const {
  return static_cast<int>(em(gap_em + width_em));
}

void CalibrationScreen::kind_buttons() {
  for (const KindRow& row : kinds) {
    const bool is_possible = row.kind != CalibrationKind::touch_up || touch_up_refusal_.empty();
    if (button(row.name, ImGui::GetContentRegionAvail().x, is_possible,
               request_.kind == row.kind)) {
      request_.kind = row.kind;
      follow_name();
    }
    faint(is_possible ? row.about : std::string_view(touch_up_refusal_));
  }
}

void CalibrationScreen::before_panel() {
  if (viewer::text_field("your name", name_)) follow_name();
  bool is_first = true;
  for (const std::string& name : recent_names_) {
    if (!is_first) flow(name);
    is_first = false;
    if (!button(name)) continue;
    name_ = {};
    name.copy(name_.data(), name_.size() - 1);
    follow_name();
  }
  ImGui::Separator();
  kind_buttons();
  ImGui::Separator();
  if (request_.kind != CalibrationKind::touch_up) {
    viewer::number_field("hand length", length_mm_, 140.0F, 230.0F, "%.0f mm");
    viewer::show_text("From the wrist's crease to the tip of the middle finger. Leave it as it is "
                      "if you do not know it: the poses show it as well.");
  }
  if (has_kept_) viewer::check("continue the poses of last time", continues_);
  const bool is_possible = !request_.user.empty() && latest_.has_value();
  if (main_button("Start", is_possible)) begin_guide();
  if (request_.user.empty())
    faint("Type your name, or choose it.");
  else if (!latest_)
    faint("Start waits for the glove.");
}

void CalibrationScreen::guide_buttons() {
  const bool is_free = !guided_->is_ending();
  for (const calibrate::GuideActionRow& row : calibrate::guide_actions()) {
    const bool is_begin = row.action == GuideAction::begin;
    if (guided_->has_begun() == is_begin) continue;
    const std::size_t column = static_cast<std::size_t>(row.action) - 1;
    if (!is_begin && column % 2 == 1) ImGui::SameLine();
    const float width = (ImGui::GetContentRegionAvail().x);
    const bool is_pressed =
        is_begin ? main_button(row.label, is_free)
                 : button(row.label, column % 2 == 0 ? viewer::share_of_line(2) : width, is_free);
    viewer::show_text(std::string(row.help) + " (" + key_text(row.key) + ")");
    if (is_pressed) guided_->act(row.action);
    if (is_begin) return;
  }
}

/// The poses, in their order. One that is taken can be taken again by a click.
void CalibrationScreen::chips() {
  std::map<hand::PoseId, int> takes;
  const ImGuiStyle& style = ImGui::GetStyle();
  std::optional<std::size_t> asked;
  for (std::size_t number = 0; number < guide_->pose_count(); ++number) {
    const int take = ++takes[guide_->pose(number)];
    const std::string name =
        calibrate::title_of(guide_->pose(number)) + (take > 1 ? " " + std::to_string(take) : "");
    if (number > 0) flow(name);
    const bool is_now = guided_->has_begun() && !guide_->is_done() && number == guide_->number();
    const bool is_kept = guide_->is_kept(number);
    ImVec4 fill = is_now ? viewer::accent() : success();
    if (!is_now) fill.w = is_kept ? 0.25F : 0.0F;
    ImGui::PushStyleColor(ImGuiCol_Button, fill);
    ImGui::PushStyleColor(ImGuiCol_Text,
                          is_now ? ImVec4(1.0F, 1.0F, 1.0F, 1.0F) : style.Colors[ImGuiCol_Text]);
    const bool is_pressed = button(name, 0.0F, is_kept || is_now);
    ImGui::PopStyleColor(2);
    viewer::show_text(std::string(hand::pose_of(guide_->pose(number)).instruction) +
                      (is_kept ? " Taken; a click takes it again." : ""));
    if (is_pressed && is_kept) asked = number;
  }
  if (asked) guided_->ask_for(*asked);
}

void CalibrationScreen::guide_panel() {
  if (!guided_->has_begun()) {
    wrapped("First, show how far each joint goes.");
  } else if (!guided_->is_ending()) {
    wrapped("Pose " + std::to_string(guide_->number() + 1) + " of " +
            std::to_string(guide_->pose_count()) + ": " + calibrate::title_of(guide_->asked()) +
            (guide_->is_again() ? ", once more" : ""));
  }
  guide_buttons();
  if (const std::string notice = notice_text(guided_->notice()); !notice.empty())
    wrapped(notice, viewer::warning());
  ImGui::Separator();
  chips();
  ImGui::Separator();
  if (button("Leave", ImGui::GetContentRegionAvail().x)) leave();
  viewer::show_text("Closes the calibration. The poses taken so far are kept for the next time. "
                    "(q)");
}

void CalibrationScreen::legend() const {
  std::map<Certainty, int> counts;
  for (const Sensor sensor : glove_.info().sensors)
    ++counts[calibrate::certainty_of(*finished_, sensor)];
  for (const auto& [certainty, count] : counts) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float radius = em(0.32F);
    ImGui::GetWindowDrawList()->AddCircleFilled(
        {at.x + radius, at.y + ImGui::GetTextLineHeight() / 2.0F}, radius,
        ImGui::GetColorU32(screen_colour(certainty)));
    ImGui::SetCursorScreenPos({at.x + em(1.0F), at.y});
    ImGui::Text("%d %s: %s", count, count == 1 ? "joint" : "joints",
                std::string(name_of(certainty)).c_str());
  }
  faint("The poses are " +
        gloves::fixed(to_degrees(calibrate::typical_residual_rad(*finished_)), 1) +
        " degrees from the calibration, typically.");
}

/// The four pairs that touch in the try.
void CalibrationScreen::pairs() const {
  for (std::size_t at = 0; at < nearest_m_.size(); ++at) {
    const std::string finger(calibrate::in_words(static_cast<hand::Finger>(at + 1)));
    const auto& nearest_m = nearest_m_[at];
    const bool is_touched = nearest_m && *nearest_m <= touch_m;
    const std::string state = is_touched  ? "touched"
                              : nearest_m ? gloves::fixed(1e3 * *nearest_m, 0) + " mm apart at best"
                                          : "";
    ImGui::TextUnformatted(("thumb, " + finger).c_str());
    ImGui::SameLine(em(10.0F));
    ImGui::TextColored(is_touched ? success() : ImGui::GetStyle().Colors[ImGuiCol_TextDisabled],
                       "%s", state.c_str());
    viewer::note_control(is_touched ? "touched " + finger : "not touched " + finger, state);
  }
}

void CalibrationScreen::after_panel() {
  legend();
  ImGui::Separator();
  if (!findings_.empty()) {
    // The buttons below stay visible in a small window.
    const float rest = em(problem_.empty() ? 27.0F : 32.0F);
    const float high = std::clamp(ImGui::GetMainViewport()->WorkSize.y - rest, em(4.0F),
                                  em(findings_.size() > 2 ? 15.0F : 11.5F));
    ImGui::BeginChild("findings", ImVec2(0.0F, high), true);
    for (const calibrate::Finding& finding : findings_) {
      wrapped(finding.text);
      faint(finding.remedy);
      ImGui::Spacing();
    }
    ImGui::EndChild();
  }
  wrapped("Try it:");
  pairs();
  ImGui::Separator();
  viewer::check("keep learning while I work", adapt_);
  viewer::show_text(
      "Corrects slowly how far the sensors slip while the glove is worn, as nendo run "
      "--adapt does.");
  if (main_button("Keep")) keep_result();
  viewer::show_text("Writes the calibration. From now on it is used for this name and glove.");
  if (button("Take poses again", viewer::share_of_line(2))) take_again();
  viewer::show_text("Goes back to the poses, to the one that agrees least.");
  ImGui::SameLine();
  if (button("Discard", ImGui::GetContentRegionAvail().x)) {
    file_->forget_kept();
    outcome_.emplace(CalibrationOutcome{});
  }
  viewer::show_text("Writes nothing, and forgets the poses. An earlier calibration remains.");
}

/// Follows the keys that the terminal has.
void CalibrationScreen::guide_keys() {
  if (!viewer::takes_keys()) return;
  for (const calibrate::GuideActionRow& row : calibrate::guide_actions()) {
    const int key = row.key == ' ' ? ' ' : row.key - 'a' + 'A'; // GLFW's numbers
    if (viewer::pressed(key)) guided_->act(row.action);
  }
  if (viewer::pressed('Q')) leave();
}

void CalibrationScreen::draw_panel(const viewer::SceneWindow& window) {
  const float gap = em(gap_em), top = window.above_px() + gap;
  const float high = ImGui::GetIO().DisplaySize.y - top - gap;
  const driver::GloveInfo& info = glove_.info();
  const std::string side(nendo::name_of(info.side));
  const std::string title = (stage_ == Stage::before ? "Calibrate the " + side + " hand"
                                                     : request_.user + ", " + side + " hand") +
                            "###calibration";
  viewer::begin_pane(title.c_str(), {gap, top}, {0.0F, 0.0F},
                     {em(width_em), std::max(em(3.0F), high)},
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoNavInputs);
  if (!problem_.empty()) {
    wrapped(problem_, viewer::warning());
    viewer::note_control("problem", "");
  }
  switch (stage_) {
  case Stage::before:
    before_panel();
    break;
  case Stage::guiding:
    guide_panel();
    break;
  case Stage::fitting:
    wrapped("Computing ...");
    break;
  case Stage::after:
    after_panel();
    break;
  }
  ImGui::Separator();
  faint(info.model + ", " +
        (latest_ ? gloves::fixed(glove_.stats().rate_hz, 0) + " samples per second"
                 : std::string("silent")));
  ImGui::End();
  if (stage_ == Stage::guiding && !outcome_) guide_keys();
}

void CalibrationScreen::draw_banner(const viewer::SceneWindow& window) const {
  const Banner words = banner();
  const float left = static_cast<float>(covered_px());
  const float free_width = ImGui::GetIO().DisplaySize.x - left;
  const float width = std::min(free_width - 2.0F * em(gap_em), em(52.0F));
  viewer::begin_pane("banner", {left + free_width / 2.0F, window.above_px() + em(gap_em)},
                     {0.5F, 0.0F}, {width, 4096.0F},
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                         ImGuiWindowFlags_NoNav);
  ImGui::PushFont(viewer::large_font());
  wrapped(words.instruction);
  viewer::note_control("instruction", "");
  if (words.warns)
    wrapped(words.state, viewer::warning());
  else
    faint(words.state);
  viewer::note_control(words.state, "");
  ImGui::PopFont();
  ImGui::End();
}

/// What the two hands are, and numbers for the joint under the mouse.
void CalibrationScreen::draw_captions(const viewer::SceneWindow& window) const {
  const Eigen::Vector3d right = window.camera().axes().row(0).transpose();
  const Eigen::Vector3d low(0.0, -0.062, 0.0);
  centred_words(window, low - aside_m * right, "how sure each joint is");
  centred_words(window, low + aside_m * right, "your hand, calibrated");
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse || !finished_) return;
  const Eigen::Vector2d mouse(static_cast<double>(io.MousePos.x),
                              static_cast<double>(io.MousePos.y));
  const auto sensor =
      sensor_at(mouse, window.camera(), window.scene_size(), report_pose_, glove_.info().sensors);
  if (!sensor) return;
  const auto certainty = calibrate::certainty_of(*finished_, *sensor);
  std::string text =
      std::string(calibrate::in_words(*sensor)) + ": " + std::string(name_of(certainty));
  const hand::SensorFit& fit = finished_->fit.sensors[index_of(*sensor)];
  if (certainty != Certainty::estimated)
    text += ". Sure to " + gloves::fixed(to_degrees(fit.deviation_rad), 1) +
            " degrees; the poses are " + gloves::fixed(to_degrees(fit.residual_rad), 1) +
            " degrees off.";
  ImGui::SetTooltip("%s", text.c_str());
}

/// The ring about the wrist: while joints show their ranges, how many have; and then, how long the
/// hand has been still.
void CalibrationScreen::draw_ring(const viewer::SceneWindow& window) const {
  if (guided_->is_ending()) return;
  const float share =
      static_cast<float>(guided_->has_begun() ? guide_->capture().progress() : shown_ranges());
  const ImVec2 middle = pixel(window, Eigen::Vector3d::Zero());
  const ImVec2 edge = pixel(window, {0.0, 0.058, 0.0});
  const float radius = std::hypot(edge.x - middle.x, edge.y - middle.y), width = radius / 5.0F;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  constexpr int segments = 96;
  list.AddCircle(middle, radius, IM_COL32(90, 98, 106, 70), segments, width);
  if (share <= 0.0F) return;
  constexpr auto turn = 2.0F * std::numbers::pi_v<float>;
  const bool warns = guided_->has_begun() && !advice_.empty();
  const ImU32 colour = ImGui::GetColorU32(warns ? viewer::warning() : success());
  if (share >= 1.0F) return list.AddCircle(middle, radius, colour, segments, width);
  list.PathArcTo(middle, radius, -turn / 4.0F, -turn / 4.0F + share * turn, segments);
  list.PathStroke(colour, 0, width);
}

} // namespace nendo::studio
