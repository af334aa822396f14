#include "studio/studio_flow.hpp"

#include <utility>

#include <nendo/base/endings.hpp>

#include "session/kept_state.hpp"
#include "studio/opened_files.hpp"

namespace nendo::studio {

bool StudioFlow::goes_on() {
  Wish wish = left_for();
  // A run that has ended by itself ends the studio, unless the user would lose edits.
  if (!is_wish(wish) && has_edits_to_lose()) wish = Go{Screen::timeline};
  if (!is_wish(wish)) is_over_ = true;
  follow(wish);
  return !is_over_;
}

void StudioFlow::follow(const Wish& wish) {
  if (const auto* const shape = std::get_if<Shape>(&wish)) begin_run(*shape);
  if (const auto* const file = std::get_if<Open>(&wish)) open(*file);
  if (std::holds_alternative<Quit>(wish)) is_over_ = true;
  const auto* const there = std::get_if<Go>(&wish);
  if (there == nullptr) return;
  switch (there->screen) {
  case Screen::start:
    return leave_screen();
  case Screen::shaping:
    next_ = Shape{};
    return;
  case Screen::puppet:
    next_ = Shape{{}, {}, "face"};
    return;
  case Screen::timeline:
    return enter_timeline({});
  case Screen::calibration:
    return calibrate(there->glove);
  }
}

void StudioFlow::begin_with(const std::string& file) {
  session::keep_recent_file(file);
  if (opens_in_timeline(file)) return enter_timeline(file);
  next_ = ends_in(file, ".toml") ? Shape{{}, {}, file} : Shape{file};
}

std::optional<Shape> StudioFlow::take_next() {
  if (next_) next_->learns_for = learns_for_;
  return std::exchange(next_, std::nullopt);
}

void StudioFlow::calibrate(NamedGlove glove) {
  for (const NamedGlove& named : options_.gloves)
    if (glove.spec.empty()) glove = named;
  if (glove.spec.empty()) glove = found_glove();
  leave_screen();
  if (glove.spec.empty())
    return show_error("No glove is here to calibrate. Plug one in, and choose Calibrate beside its "
                      "hand.");
  enter_calibration(glove);
}

} // namespace nendo::studio
