#include <nendo/flow/wanted_settings.hpp>

#include <algorithm>

namespace nendo::flow {

bool WantedSettings::follow(const LoopSettings& in_force) noexcept {
  if (in_force == now || HostClock::now() - asked_at_ < patience) return false;
  now = asked_ = in_force;
  return true;
}

std::optional<Command> WantedSettings::ask() noexcept {
  if (now == asked_) return std::nullopt;
  asked_ = now;
  asked_at_ = HostClock::now();
  return ChangeSettings{now};
}

void WantedSettings::other_mode() noexcept {
  now.mode = now.mode == Mode::type1 ? Mode::type2 : Mode::type1;
}

void WantedSettings::next_kernel() noexcept {
  const auto* const at = std::find(kernels.begin(), kernels.end(), now.kernel);
  now.kernel = kernels[static_cast<std::size_t>(at - kernels.begin() + 1) % kernels.size()];
}

void WantedSettings::scale_radii(double factor) noexcept {
  for (double& radius_m : now.radius_m)
    radius_m = std::clamp(factor * radius_m, least_radius_m, most_radius_m);
}

bool WantedSettings::has_one_radius() const noexcept {
  return std::all_of(now.radius_m.begin(), now.radius_m.end(),
                     [this](double radius_m) { return radius_m == now.radius_m[0]; });
}

} // namespace nendo::flow
