#include "viewer/dope_sheet_widget.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <imgui.h>

#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/picture_card.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

ImU32 of_style(ImGuiCol item) {
  return ImGui::GetColorU32(item);
}

using Pictures = std::map<std::shared_ptr<const render::Image>, gl::Picture>;

/// Draws the strip, from a corner in the window. Measures in pixels of a screen of scale 1.
class StripDrawing {
public:
  StripDrawing(const DopeSheet& strip, const TimelineView& view, ImVec2 corner, ImVec2 size)
      : strip_(strip), view_(view), corner_(corner), width_(static_cast<double>(size.x / scale_)),
        height_(static_cast<double>(size.y / scale_)), begin_(std::max(DopeSheet::left, x_of(0.0))),
        end_(std::min(width_, x_of(view.duration_s))) {}

  void grounds() const {
    fill(0.0, 0.0, width_, height_, ground);
    for (std::size_t lane = 0; lane <= view_.lanes.size(); ++lane) {
      const double middle = DopeSheet::middle_of(lane);
      fill(begin_, middle - half_lane, end_, middle + half_lane, lane_ground);
      const bool is_events = lane == view_.lanes.size();
      text(6.0, middle, words, is_events ? "events" : name_of(view_.lanes[lane].side));
    }
    constexpr double top = DopeSheet::ruler - 5.0, bottom = DopeSheet::ruler - 1.0;
    fill(begin_, top, end_, bottom, line);
    fill(begin_, top, std::clamp(x_of(view_.computed_s), begin_, end_), bottom, strong);
  }

  /// Beside the play head where it is at a line.
  void rule() const {
    const double step_s = strip_.ruler_step_s();
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step_s) + 1e-9)));
    for (double number = std::ceil(strip_.first_s() / step_s); number * step_s <= strip_.last_s();
         number += 1.0) {
      const double x = strip_.x_of(number * step_s);
      list_.AddLine(at(x, 4.0), at(x, height_), line);
      char label[32];
      std::snprintf(label, sizeof label, "%.*f", decimals, number * step_s);
      text(std::min(x + 7.0, width_ - length_of(label) - 2.0), 10.0, words, label);
    }
  }

  // As wide as its cell, which shows the middle of a wide picture.
  void show(const Pictures& pictures) const {
    constexpr double top = DopeSheet::ruler, bottom = top + DopeSheet::pictures;
    text(6.0, (top + bottom) / 2.0, words, "shape");
    list_.PushClipRect(at(DopeSheet::left, top), at(width_, bottom), true);
    for (const StripPicture& cell : view_.pictures) {
      const double from = strip_.x_of(cell.from_s) + 0.5, to = strip_.x_of(cell.to_s) - 0.5;
      const auto found = pictures.find(cell.image);
      if (found == pictures.end()) {
        fill(from, top + 1.0, to, bottom - 1.0, lane_ground);
        continue;
      }
      const auto& [across, down] = cell.image->size();
      const double shown = (to - from) / (DopeSheet::pictures - 2.0) * down / across;
      draw_picture(list_, found->second, at(from, top + 1.0), at(to, bottom - 1.0),
                   static_cast<float>(shown));
    }
    list_.PopClipRect();
  }

  void shade(const Retiming& times) const {
    const double from = std::max(DopeSheet::left, x_of(times.from_s));
    fill(from, DopeSheet::ruler, std::max(from, x_of(times.to_s)), height_, shaded);
  }

  void keys_of(std::size_t lane, const std::optional<StripKey>& pointed_at) const {
    const auto& keys_s = view_.lanes[lane].keys_s;
    const auto at_time = [&](double time_s) {
      return std::lower_bound(keys_s.begin(), keys_s.end(), time_s);
    };
    constexpr double min_gap = 1.0; // pixels; nearer ones are one to the eye
    const double pixel_s = strip_.time_at(DopeSheet::left + 1.0) - strip_.first_s();
    for (auto key = at_time(strip_.first_s() - 8.0 * pixel_s);
         key != keys_s.end() && *key <= strip_.last_s() + 8.0 * pixel_s;) {
      diamond(lane, static_cast<std::size_t>(key - keys_s.begin()), strong, edge);
      key = std::max(key + 1, at_time(*key + min_gap * pixel_s));
    }
    for (const auto& [marked, colour, rim] :
         {std::tuple{pointed_at, words, edge}, {view_.selected, chosen, words}})
      if (marked && marked->lane == lane && marked->key < keys_s.size())
        diamond(lane, marked->key, colour, rim);
  }

  // A name is written where it fits before the next.
  void marks() const {
    const double y = DopeSheet::middle_of(view_.lanes.size());
    double free_from = 0.0;
    for (std::size_t mark = 0; mark < view_.marks.size(); ++mark) {
      const double x = strip_.x_of(view_.marks[mark].time_s);
      if (x < DopeSheet::left || x > width_) continue;
      fill(x - 1.0, y - 10.0, x + 1.0, y + 10.0, faint);
      const std::string& name = view_.marks[mark].name;
      const double end = x + 4.0 + length_of(name);
      const bool is_last = mark + 1 == view_.marks.size();
      const double next = is_last ? width_ : strip_.x_of(view_.marks[mark + 1].time_s);
      if (x < free_from || end > std::min(next - 2.0, width_)) continue;
      text(x + 4.0, y, faint, name);
      free_from = end;
    }
  }

  void head() const {
    const double x = strip_.x_of(view_.head_s);
    if (x < DopeSheet::left - 1.0 || x > width_) return;
    fill(x - 1.0, 0.0, x + 1.0, height_, chosen);
    list_.AddTriangleFilled(at(x - 6.0, 0.0), at(x + 6.0, 0.0), at(x, 9.0), chosen);
  }

private:
  ImVec2 at(double x, double y) const {
    return {corner_.x + scale_ * static_cast<float>(x), corner_.y + scale_ * static_cast<float>(y)};
  }
  double x_of(double time_s) const { // a little beyond the strip where it is beyond
    return std::clamp(strip_.x_of(time_s), DopeSheet::left - 20.0, width_ + 20.0);
  }
  double length_of(const std::string& what) const {
    return static_cast<double>(ImGui::CalcTextSize(what.c_str()).x / scale_);
  }
  void fill(double x0, double y0, double x1, double y1, ImU32 colour) const {
    list_.AddRectFilled(at(x0, y0), at(x1, y1), colour);
  }
  void text(double x, double middle, ImU32 colour, std::string_view what) const {
    list_.AddText(at(x, middle - 7.0), colour, what.data(), what.data() + what.size());
  }
  void diamond(std::size_t lane, std::size_t key, ImU32 colour, ImU32 rim) const {
    constexpr double half = 7.0;
    const double x = strip_.x_of(view_.lanes[lane].keys_s[key]), y = DopeSheet::middle_of(lane);
    if (x < DopeSheet::left - half || x > width_ + half) return;
    const ImVec2 top = at(x, y - half), side = at(x + half, y);
    const ImVec2 bottom = at(x, y + half), other = at(x - half, y);
    list_.AddQuadFilled(top, side, bottom, other, colour);
    list_.AddQuad(top, side, bottom, other, rim, 1.5F);
  }

  static constexpr double half_lane = DopeSheet::lane / 2 - 1.0;
  const ImU32 ground = of_style(ImGuiCol_WindowBg), lane_ground = of_style(ImGuiCol_FrameBg);
  const ImU32 line = of_style(ImGuiCol_Border), words = of_style(ImGuiCol_Text);
  const ImU32 faint = of_style(ImGuiCol_TextDisabled), edge = of_style(ImGuiCol_PopupBg);
  const ImU32 strong = of_style(ImGuiCol_PlotHistogram), chosen = ImGui::GetColorU32(accent());
  const ImU32 shaded = ImGui::GetColorU32(accent(0.16F));
  const DopeSheet& strip_;
  const TimelineView& view_;
  ImDrawList& list_ = *ImGui::GetWindowDrawList();
  const float scale_ = scale();
  const ImVec2 corner_;
  const double width_, height_;
  const double begin_, end_; ///< the timeline's, as far as it is visible
};

constexpr float controls_em = 2.4F;
constexpr float margin_em = 0.4F;
constexpr double drag_begins_px = 3.0;

void show_tooltip_at(const TimelineView& view, const DopeSheet& strip, double x, double y) {
  if (const auto key = strip.key_at(view.lanes, x, y))
    ImGui::SetTooltip("key %zu, %.3f s", key->key, view.lanes[key->lane].keys_s[key->key]);
  else if (const auto mark = strip.mark_at(view.marks, view.lanes.size(), x, y))
    ImGui::SetTooltip("%s, %.3f s", view.marks[*mark].name.c_str(), view.marks[*mark].time_s);
}

// To a frame's time, as Player has it, within the timeline.
double on_a_frame(double time_s, const TimelineView& view) {
  const double frame = std::round(time_s * view.rate_hz);
  const double last = std::floor(view.duration_s * view.rate_hz);
  return std::clamp(frame, 0.0, std::max(0.0, last)) / view.rate_hz;
}

} // namespace

int DopeSheetWidget::height_for(std::size_t lanes) noexcept {
  return static_cast<int>(scale() * static_cast<float>(DopeSheet::height_for(lanes)) +
                          em(controls_em + 2.0F * margin_em));
}

void DopeSheetWidget::draw(const TimelineView& view, const std::optional<Retiming>& shaded,
                           EditActions& actions) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const auto height = static_cast<float>(height_for(view.lanes.size()));
  const float margin = em(margin_em), px = scale();
  ImGui::SetNextWindowPos(ImVec2(0.0F, all.y - height));
  ImGui::SetNextWindowSize(ImVec2(all.x, height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(margin, margin));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::Begin("strip", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
  controls(view, actions);
  const ImVec2 corner(margin, all.y - height + margin + em(controls_em));
  const ImVec2 size(std::max(64.0F, all.x - 2.0F * margin),
                    px * static_cast<float>(DopeSheet::height_for(view.lanes.size())));
  strip_.fit(static_cast<double>(size.x / px), view.duration_s);
  if (std::exchange(head_s_, view.head_s) != view.head_s) strip_.follow(view.head_s);
  ImGui::SetCursorScreenPos(corner);
  ImGui::InvisibleButton("keys", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const auto x = static_cast<double>((mouse.x - corner.x) / px);
  const auto y = static_cast<double>((mouse.y - corner.y) / px);
  follow_mouse(view, x, y, actions);
  std::optional<StripKey> pointed_at;
  if (ImGui::IsItemHovered()) {
    pointed_at = strip_.key_at(view.lanes, x, y);
    if (!taken_) show_tooltip_at(view, strip_, x, y);
  }
  follow_pictures(view.pictures);
  const StripDrawing drawing(strip_, view, corner, size);
  drawing.grounds();
  drawing.rule();
  drawing.show(pictures_);
  if (shaded) drawing.shade(*shaded);
  for (std::size_t lane = 0; lane < view.lanes.size(); ++lane)
    drawing.keys_of(lane, pointed_at);
  drawing.marks();
  drawing.head();
  actions.cells = strip_.cells();
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void DopeSheetWidget::follow_pictures(const std::vector<StripPicture>& shown) {
  for (const StripPicture& cell : shown)
    if (cell.image) pictures_.try_emplace(cell.image, *cell.image);
  std::erase_if(pictures_, [&](const auto& one) {
    return std::ranges::find(shown, one.first, &StripPicture::image) == shown.end();
  });
}

void DopeSheetWidget::controls(const TimelineView& view, EditActions& actions) const {
  edit_buttons(commands::Buttons::head, view.facts, em(2.3F), actions.commands);
  ImGui::SameLine();
  bool loops = view.loops;
  if (check("loop", loops)) actions.commands.push_back(EditCommand::loop);
  show_help("loop");
  ImGui::SameLine();
  auto speed = static_cast<float>(view.speed);
  if (bar_field("speed", speed, 0.1F, 4.0F, "speed %.2f", em(7.4F)))
    actions.speed = static_cast<double>(speed);
  show_text("How fast the timeline plays (Ctrl Up, Ctrl Down).");
  ImGui::SameLine();
  ImGui::Text("%.3f s of %.3f s", view.head_s, view.duration_s);
  ImGui::SameLine();
  if (view.computing)
    ImGui::TextDisabled("shapes made to %.2f s", view.computed_s);
  else if (view.shape_is_old)
    ImGui::TextDisabled("the shape does not show the last edits");
}

void DopeSheetWidget::follow_mouse(const TimelineView& view, double x, double y,
                                   EditActions& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && io.MouseWheel != 0.0F)
    strip_.zoom(x, static_cast<double>(io.MouseWheel));
  if (ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Middle))
    strip_.pan(static_cast<double>(io.MouseDelta.x / scale()));
  if (ImGui::IsItemActivated() && ImGui::IsMouseClicked(ImGuiMouseButton_Left))
    press(view, x, y, actions);
  if (taken_ && is_struck(commands::row_of(EditCommand::select_none))) {
    if (taken_->moved) actions.drop = true;
    taken_.reset();
  }
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    drag(view, x, actions);
    return;
  }
  if (taken_ && taken_->moved) actions.keep = true;
  taken_.reset();
  scrubs_ = false;
}

void DopeSheetWidget::press(const TimelineView& view, double x, double y, EditActions& actions) {
  if (const auto key = strip_.key_at(view.lanes, x, y)) {
    actions.select = key;
    taken_ = Taken{*key, x, false};
  } else if (const auto mark = strip_.mark_at(view.marks, view.lanes.size(), x, y)) {
    actions.seek_s = view.marks[*mark].time_s;
  } else {
    scrubs_ = true;
  }
}

void DopeSheetWidget::drag(const TimelineView& view, double x, EditActions& actions) {
  if (scrubs_) actions.seek_s = strip_.time_at(x);
  if (!taken_) return;
  if (!taken_->moved) {
    if (std::abs(x - taken_->pressed_x) < drag_begins_px) return;
    taken_->moved = true;
  }
  actions.tried = KeyDrag{taken_->key, on_a_frame(strip_.time_at(x), view), ImGui::GetIO().KeyCtrl};
}

} // namespace nendo::viewer
