#include <nendo/flow/wire_path.hpp>

#include <algorithm>

namespace nendo::flow {

namespace {

/// The least step, in lengths of the wire: a degree and a half that a hand trembles.
constexpr double min_turn = 0.025;
constexpr double back = 1.5;       // steps: nearer than that, a wire has come back
constexpr double max_detour = 6.0; // steps
constexpr int smoothings = 16;     // as a Gaussian of 2.8 places

double way_between(const deform::WirePlace& a, const deform::WirePlace& b) noexcept {
  return std::max((a.from - b.from).norm(), (a.to - b.to).norm());
}

} // namespace

void WirePath::begin(double step) noexcept {
  clear();
  step_ = step;
  is_drawing_ = true;
}

void WirePath::draw_to(const deform::WirePlace& place) noexcept {
  if (!is_drawing_ || !place.from.allFinite() || !place.to.allFinite()) return;
  ++version_;
  last_ = place;
  step_ = std::max(step_, min_turn * (place.to - place.from).norm());
  if (is_near_last(place)) return;
  forget_detour(place);
  if (is_near_last(place)) return;
  if (count_ == max_places) thin_out();
  places_[count_++] = place;
}

bool WirePath::is_near_last(const deform::WirePlace& place) const noexcept {
  return count_ > 0 && way_between(place, places_[count_ - 1]) < step_;
}

/// A hand at rest trembles, and a blade that goes back and forth passes through itself.
/// Where the wire comes back to a place by a short way, that way is forgotten.
void WirePath::forget_detour(const deform::WirePlace& place) noexcept {
  double detour = count_ > 0 ? way_between(place, places_[count_ - 1]) : 0.0;
  for (std::uint32_t at = count_; at > 1 && detour <= max_detour * step_; --at) {
    if (way_between(place, places_[at - 2]) < back * step_) count_ = at - 1;
    detour += way_between(places_[at - 1], places_[at - 2]);
  }
}

/// Fingers tremble and sensors have steps of half a degree, but a taut wire does not ripple. Both
/// ends stay.
void WirePath::smooth() noexcept {
  for (int round = 0; round < smoothings; ++round) {
    deform::WirePlace before = places_[0];
    for (std::uint32_t at = 1; at + 1 < count_; ++at) {
      const deform::WirePlace here = places_[at];
      const deform::WirePlace& next = places_[at + 1];
      places_[at] = {0.25 * before.from + 0.5 * here.from + 0.25 * next.from,
                     0.25 * before.to + 0.5 * here.to + 0.25 * next.to};
      before = here;
    }
  }
}

/// The first place stays.
void WirePath::thin_out() noexcept {
  step_ *= 2.0;
  count_ = 0;
  for (std::size_t at = 0; at < max_places; at += 2)
    places_[count_++] = places_[at];
}

void WirePath::end() noexcept {
  if (!is_drawing_) return;
  ++version_;
  is_drawing_ = false;
  if (count_ == 0) return;
  if (count_ == max_places) thin_out();
  if (way_between(last_, places_[count_ - 1]) > 0.5 * step_) {
    forget_detour(last_);
    places_[count_++] = last_;
  } else if (count_ > 1) {
    places_[count_ - 1] = last_;
  }
  smooth();
  if (count_ > 1) ++completed_;
}

void WirePath::clear() noexcept {
  ++version_;
  count_ = 0;
  is_drawing_ = false;
}

} // namespace nendo::flow
