#include "forms/dope_sheet_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <utility>

namespace nendo::forms {
namespace {

using Colour = Drawing::Colour;

/// Draws the sheet.
class SheetDrawing {
public:
  SheetDrawing(const DopeSheet& strip, const TimelineView& view, double width)
      : strip_(strip), view_(view), width_(width),
        height_(DopeSheet::height_for(view.lanes.size())),
        begin_(std::max(DopeSheet::left, x_of(0.0))),
        end_(std::min(width_, x_of(view.duration_s))) {
    drawing_.width = width_;
    drawing_.height = height_;
    drawing_.takes_pointer = true;
  }

  void grounds() {
    drawing_.rectangle(0.0, 0.0, width_, height_, Colour::window);
    for (std::size_t lane = 0; lane <= view_.lanes.size(); ++lane) {
      const double middle = DopeSheet::middle_of(lane);
      drawing_.rectangle(begin_, middle - half_lane, end_, middle + half_lane, Colour::field);
      const bool is_events = lane == view_.lanes.size();
      text(6.0, middle, Colour::ink, is_events ? "events" : name_of(view_.lanes[lane].side));
    }
    constexpr double top = DopeSheet::ruler - 5.0, bottom = DopeSheet::ruler - 1.0;
    drawing_.rectangle(begin_, top, end_, bottom, Colour::line);
    drawing_.rectangle(begin_, top, std::clamp(x_of(view_.computed_s), begin_, end_), bottom,
                       Colour::chart);
  }

  /// Beside the play head where it is at a line.
  void rule() {
    const double step_s = strip_.ruler_step_s();
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step_s) + 1e-9)));
    for (double number = std::ceil(strip_.first_s() / step_s); number * step_s <= strip_.last_s();
         number += 1.0) {
      const double x = strip_.x_of(number * step_s);
      drawing_.line({at(x, 4.0), at(x, height_)}, Colour::line);
      char label[32];
      std::snprintf(label, sizeof label, "%.*f", decimals, number * step_s);
      text(std::min(x + 7.0, width_ - Drawing::width_of(label) - 2.0), 10.0, Colour::ink, label);
    }
  }

  // As wide as its cell, which shows the middle of a wide picture.
  void pictures() {
    constexpr double top = DopeSheet::ruler + 1.0, bottom = top + DopeSheet::pictures - 2.0;
    text(6.0, (top + bottom) / 2.0, Colour::ink, "shape");
    for (const StripPicture& cell : view_.pictures) {
      const double from = strip_.x_of(cell.from_s) + 0.5, to = strip_.x_of(cell.to_s) - 0.5;
      const double seen_from = std::clamp(from, DopeSheet::left, width_);
      const double seen_to = std::clamp(to, seen_from, width_);
      if (cell.image == nullptr)
        drawing_.rectangle(seen_from, top, seen_to, bottom, Colour::field);
      else
        drawing_.shapes.push_back(
            {Drawing::Kind::picture,
             Colour::ink,
             {at(from, top), at(to, bottom), at(seen_from, top), at(seen_to, bottom)},
             Colour::control,
             {},
             cell.image});
    }
  }

  void shade(const Retiming& times) {
    const double from = std::max(DopeSheet::left, x_of(times.from_s));
    drawing_.rectangle(from, DopeSheet::ruler, std::max(from, x_of(times.to_s)), height_,
                       Colour::shade);
  }

  void keys_of(std::size_t lane, const std::optional<StripKey>& pointed_at) {
    const auto& keys_s = view_.lanes[lane].keys_s;
    const auto at_time = [&](double time_s) {
      return std::lower_bound(keys_s.begin(), keys_s.end(), time_s);
    };
    const double first_s = strip_.first_s(), last_s = strip_.last_s();
    const double pixel_s = (last_s - first_s) / (strip_.x_of(last_s) - strip_.x_of(first_s));
    for (auto key = at_time(strip_.first_s() - 8.0 * pixel_s);
         key != keys_s.end() && *key <= strip_.last_s() + 8.0 * pixel_s;) {
      diamond(lane, static_cast<std::size_t>(key - keys_s.begin()), Colour::chart, Colour::control);
      key = std::max(key + 1, at_time(*key + min_gap * pixel_s));
    }
    for (const auto& [marked, colour, rim] : {std::tuple{pointed_at, Colour::ink, Colour::control},
                                              {view_.selected, Colour::accent, Colour::ink}})
      if (marked && marked->lane == lane && marked->key < keys_s.size())
        diamond(lane, marked->key, colour, rim);
  }

  // A name is written where it fits before the next.
  void marks() {
    const double y = DopeSheet::middle_of(view_.lanes.size());
    double free_from = 0.0, next_from = DopeSheet::left;
    for (std::size_t mark = 0; mark < view_.marks.size(); ++mark) {
      const double x = strip_.x_of(view_.marks[mark].time_s);
      if (x < next_from || x > width_) continue;
      next_from = x + min_gap;
      drawing_.rectangle(x - 1.0, y - 10.0, x + 1.0, y + 10.0, Colour::soft);
      const std::string& name = view_.marks[mark].name;
      const double end = x + 4.0 + Drawing::width_of(name);
      const bool is_last = mark + 1 == view_.marks.size();
      const double next = is_last ? width_ : strip_.x_of(view_.marks[mark + 1].time_s);
      if (x < free_from || end > std::min(next - 2.0, width_)) continue;
      text(x + 4.0, y, Colour::soft, name);
      free_from = end;
    }
  }

  void head() {
    const double x = strip_.x_of(view_.head_s);
    if (x < DopeSheet::left - 1.0 || x > width_) return;
    drawing_.rectangle(x - 1.0, 0.0, x + 1.0, height_, Colour::accent);
    drawing_.area({at(x - 6.0, 0.0), at(x + 6.0, 0.0), at(x, 9.0)}, Colour::accent);
  }

  /// Returns the drawing of all that was drawn.
  Drawing take() { return std::move(drawing_); }

private:
  static Eigen::Vector2f at(double x, double y) {
    return {static_cast<float>(x), static_cast<float>(y)};
  }
  double x_of(double time_s) const { // a little beyond the strip where it is beyond
    return std::clamp(strip_.x_of(time_s), DopeSheet::left - 20.0, width_ + 20.0);
  }
  void text(double x, double middle, Colour colour, std::string_view words) {
    drawing_.text(x, middle, colour, std::string(words));
  }
  void diamond(std::size_t lane, std::size_t key, Colour colour, Colour rim) {
    const double x = strip_.x_of(view_.lanes[lane].keys_s[key]);
    if (x < DopeSheet::left - Drawing::half_diamond || x > width_ + Drawing::half_diamond) return;
    drawing_.diamond(x, DopeSheet::middle_of(lane), colour, rim);
  }

  static constexpr double half_lane = DopeSheet::lane / 2 - 1.0;
  static constexpr double min_gap = 2.0; ///< px; nearer keys or marks are one to the eye
  const DopeSheet& strip_;
  const TimelineView& view_;
  const double width_, height_;
  const double begin_, end_; ///< the timeline's, as far as it is visible
  Drawing drawing_;
};

std::string tooltip_at(const TimelineView& view, const DopeSheet& strip,
                       const Eigen::Vector2d& at) {
  if (at.x() < DopeSheet::left)
    return "A drag scrubs, the wheel zooms, a drag with the middle button shifts the view.\n"
           "A click selects a key, a drag moves it, and with Ctrl copies it.";
  char text[160] = "";
  if (const auto key = strip.key_at(view.lanes, at.x(), at.y()))
    std::snprintf(text, sizeof text, "key %zu, %.3f s", key->key,
                  view.lanes[key->lane].keys_s[key->key]);
  else if (const auto mark = strip.mark_at(view.marks, view.lanes.size(), at.x(), at.y()))
    std::snprintf(text, sizeof text, "%s, %.3f s", view.marks[*mark].name.c_str(),
                  view.marks[*mark].time_s);
  return text;
}

// To a frame's time, as Player has it, within the timeline.
double on_a_frame(double time_s, const TimelineView& view) {
  const double frame = std::round(time_s * view.rate_hz);
  const double last = std::floor(view.duration_s * view.rate_hz);
  return std::clamp(frame, 0.0, std::max(0.0, last)) / view.rate_hz;
}

} // namespace

void DopeSheetForm::describe(Form& form, const TimelineView& view,
                             const std::optional<Retiming>& shaded, EditActions& actions) {
  constexpr double usual_width = 800.0, min_width = 200.0, max_width = 8000.0;
  const double width =
      pointer_.width > 0.0 ? std::clamp(pointer_.width, min_width, max_width) : usual_width;
  strip_.fit(width, view.duration_s);
  if (std::exchange(head_s_, view.head_s) != view.head_s) strip_.follow(view.head_s);
  std::optional<StripKey> pointed_at;
  if (pointer_.at) pointed_at = strip_.key_at(view.lanes, pointer_.at->x(), pointer_.at->y());
  SheetDrawing sheet(strip_, view, width);
  sheet.grounds();
  sheet.rule();
  sheet.pictures();
  if (shaded) sheet.shade(*shaded);
  for (std::size_t lane = 0; lane < view.lanes.size(); ++lane)
    sheet.keys_of(lane, pointed_at);
  sheet.marks();
  sheet.head();
  Drawing drawing = sheet.take();
  if (pointer_.at && !taken_) drawing.tooltip = tooltip_at(view, strip_, *pointer_.at);
  const Pointer before = std::exchange(pointer_, form.drawing("dope sheet", {}, drawing));
  follow(before, view, actions);
  actions.cells = strip_.cells();
}

/// A pointer that is held still does nothing: it may be that of a page that is gone.
void DopeSheetForm::follow(const Pointer& before, const TimelineView& view, EditActions& actions) {
  const Pointer& pointer = pointer_;
  if (pointer.at && pointer.wheel != 0.0) strip_.zoom(pointer.at->x(), pointer.wheel);
  if (pointer.panned != 0.0) strip_.pan(pointer.panned);
  if (pointer.at && pointer.is_pressed) press(view, *pointer.at, actions);
  if (!pointer.at || !pointer.is_held) return end_drag(actions);
  const bool has_moved = !before.at || before.at->x() != pointer.at->x();
  if (pointer.is_pressed || has_moved || before.has_control != pointer.has_control)
    drag(view, pointer.at->x(), pointer.has_control, actions);
}

void DopeSheetForm::end_drag(EditActions& actions) {
  if (taken_ && taken_->moved) actions.keep = true;
  taken_.reset();
  scrubs_ = false;
}

bool DopeSheetForm::give_up(EditActions& actions) {
  const bool has_moved = taken_ && taken_->moved;
  if (has_moved) actions.drop = true;
  taken_.reset();
  return has_moved;
}

void DopeSheetForm::press(const TimelineView& view, const Eigen::Vector2d& at,
                          EditActions& actions) {
  if (const auto key = strip_.key_at(view.lanes, at.x(), at.y())) {
    actions.select = key;
    taken_ = Taken{*key, at.x(), false};
  } else if (const auto mark = strip_.mark_at(view.marks, view.lanes.size(), at.x(), at.y())) {
    actions.seek_s = view.marks[*mark].time_s;
  } else {
    scrubs_ = true;
  }
}

void DopeSheetForm::drag(const TimelineView& view, double x, bool copies, EditActions& actions) {
  constexpr double drag_begins_px = 3.0;
  if (scrubs_) actions.seek_s = strip_.time_at(x);
  if (!taken_) return;
  if (!taken_->moved) {
    if (std::abs(x - taken_->pressed_x) < drag_begins_px) return;
    taken_->moved = true;
  }
  actions.tried = KeyDrag{taken_->key, on_a_frame(strip_.time_at(x), view), copies};
}

} // namespace nendo::forms
