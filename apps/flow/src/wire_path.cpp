#include <nendo/flow/wire_path.hpp>

#include <algorithm>

namespace nendo::flow {

void WirePath::begin(double step) noexcept {
  clear();
  step_ = step;
  is_drawn_ = true;
}

void WirePath::draw_to(const deform::WirePlace& place) noexcept {
  if (!is_drawn_ || !place.from.allFinite() || !place.to.allFinite()) return;
  ++version_;
  last_ = place;
  if (count_ > 0) {
    const deform::WirePlace& before = places_[count_ - 1];
    const double way = std::max((place.from - before.from).norm(), (place.to - before.to).norm());
    if (way < step_) return;
  }
  if (count_ == most_places) thin_out();
  places_[count_++] = place;
}

/// The first place stays.
void WirePath::thin_out() noexcept {
  step_ *= 2.0;
  count_ = 0;
  for (std::size_t at = 0; at < most_places; at += 2)
    places_[count_++] = places_[at];
}

void WirePath::end() noexcept {
  if (!is_drawn_) return;
  ++version_;
  is_drawn_ = false;
  if (count_ == 0) return;
  if (count_ == most_places) thin_out();
  if (last_.from != places_[count_ - 1].from || last_.to != places_[count_ - 1].to)
    places_[count_++] = last_;
  if (count_ > 1) ++completed_;
}

void WirePath::clear() noexcept {
  ++version_;
  count_ = 0;
  is_drawn_ = false;
}

} // namespace nendo::flow
