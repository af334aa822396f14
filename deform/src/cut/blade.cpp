#include "cut/blade.hpp"

#include <algorithm>
#include <cassert>

namespace nendo::deform {

PlaneBlade::PlaneBlade(const SpacePoint& point, const SpacePoint& normal) noexcept
    : origin_(point), normal_(unit_of(normal)), first_(square_to(normal_)),
      second_(cross(normal_, first_)) {}

double PlaneBlade::side(const SpacePoint& point) const noexcept {
  return dot(normal_, point - origin_);
}

PlanePoint PlaneBlade::chart(const SpacePoint& point) const noexcept {
  return {dot(first_, point - origin_), dot(second_, point - origin_)};
}

SpacePoint PlaneBlade::lift(const PlanePoint& place, double above) const noexcept {
  return origin_ + above * normal_ + place[0] * first_ + place[1] * second_;
}

WireBlade::WireBlade(std::span<const WireEnds> places) {
  assert(places.size() >= 2);
  for (const WireEnds& ends : places)
    stations_.push_back({ends.from, ends.to, between(ends.from, ends.to, 0.5), {}, 0.0});
  for (std::size_t at = 0; at < stations_.size(); ++at) {
    Station& station = stations_[at];
    const Station& before = stations_[at > 0 ? at - 1 : 0];
    const Station& after = stations_[std::min(at + 1, stations_.size() - 1)];
    const SpacePoint wire = unit_of(station.to - station.from);
    const SpacePoint motion = after.middle - before.middle;
    station.onward = unit_of(motion - dot(motion, wire) * wire);
    if (at > 0) station.along = before.along + length_of(station.middle - before.middle);
  }
}

WireBlade::Passing WireBlade::passing(std::size_t before, double part) const noexcept {
  const Station& one = stations_[before];
  const Station& other = stations_[before + 1];
  const double inner = std::clamp(part, 0.0, 1.0);
  Passing result{before, part, between(one.from, other.from, inner), {}, {}, {}};
  result.wire = unit_of(between(one.to, other.to, inner) - result.from);
  result.onward = unit_of(between(one.onward, other.onward, inner));
  result.up = unit_of(cross(result.onward, result.wire));
  return result;
}

WireBlade::Passing WireBlade::passing(const SpacePoint& point) const noexcept {
  const auto ahead_of = [&](std::size_t at) {
    return dot(stations_[at].onward, point - stations_[at].middle);
  };
  std::size_t low = 0;
  std::size_t high = stations_.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (ahead_of(middle) >= 0.0 ? low : high) = middle;
  }
  const double ahead_of_low = ahead_of(low);
  const double ahead_of_high = ahead_of(high);
  const double step = stations_[high].along - stations_[low].along;
  double part = 0.0;
  if (low == 0 && ahead_of_low < 0.0)
    part = ahead_of_low / step;
  else if (high == stations_.size() - 1 && ahead_of_high > 0.0)
    part = 1.0 + ahead_of_high / step;
  else if (ahead_of_low > ahead_of_high)
    part = ahead_of_low / (ahead_of_low - ahead_of_high);
  return passing(low, part);
}

double WireBlade::side(const SpacePoint& point) const noexcept {
  const Passing wire = passing(point);
  return dot(wire.up, point - wire.from);
}

PlanePoint WireBlade::chart(const SpacePoint& point) const noexcept {
  const Passing wire = passing(point);
  const double step = stations_[wire.before + 1].along - stations_[wire.before].along;
  return {stations_[wire.before].along + wire.part * step, dot(wire.wire, point - wire.from)};
}

SpacePoint WireBlade::lift(const PlanePoint& place, double above) const noexcept {
  const auto after =
      std::upper_bound(stations_.begin() + 1, stations_.end() - 1, place[0],
                       [](double along, const Station& other) { return along < other.along; });
  const auto before = static_cast<std::size_t>(after - stations_.begin()) - 1;
  const double step = stations_[before + 1].along - stations_[before].along;
  const double part = (place[0] - stations_[before].along) / step;
  const Passing wire = passing(before, part);
  const double beyond = (part - std::clamp(part, 0.0, 1.0)) * step;
  return wire.from + above * wire.up + place[1] * wire.wire + beyond * wire.onward;
}

bool WireBlade::covers(const SpacePoint& point) const noexcept {
  const Passing wire = passing(point);
  if (wire.part < 0.0 || wire.part > 1.0) return false;
  const Station& one = stations_[wire.before];
  const Station& other = stations_[wire.before + 1];
  const double length = length_of(between(one.to, other.to, wire.part) - wire.from);
  const double place = dot(wire.wire, point - wire.from);
  return place >= 0.0 && place <= length;
}

} // namespace nendo::deform
