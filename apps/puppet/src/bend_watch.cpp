#include <nendo/puppet/bend_watch.hpp>

#include <cmath>

#include <nendo/base/units.hpp>

namespace nendo::puppet {

double BendWatch::usual_rad(std::size_t finger) noexcept {
  constexpr double thumb_deg = 40.0, others_deg = 70.0;
  return from_degrees(finger == 0 ? thumb_deg : others_deg);
}

std::optional<Bend> BendWatch::follow(const RigPlayer::Hands& hands) noexcept {
  std::optional<Bend> best;
  double most = 0.0, second = 0.0;
  for (const Side side : {Side::left, Side::right}) {
    const HandState* const hand = hands[static_cast<std::size_t>(side)];
    if (hand == nullptr) continue;
    auto& rest = rest_[static_cast<std::size_t>(side)];
    const bool is_first = !rest.has_value();
    if (is_first) rest.emplace();
    for (std::size_t finger = 0; finger < hand::finger_count; ++finger) {
      const auto signal = HandSignal::numbered(side, static_cast<std::uint8_t>(finger));
      if (!signal) continue;
      const double bent_rad = signal->of(*hand);
      if (is_first) (*rest)[finger] = bent_rad;
      const double part = (bent_rad - (*rest)[finger]) / usual_rad(finger);
      if (!(std::abs(part) > second)) continue;
      if (std::abs(part) <= most) {
        second = std::abs(part);
        continue;
      }
      second = most;
      most = std::abs(part);
      best = Bend{*signal, std::copysign(usual_rad(finger), part)};
    }
  }
  if (most < min_bend_fraction || most < dominance_ratio * second) return std::nullopt;
  return best;
}

} // namespace nendo::puppet
