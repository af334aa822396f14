#include <nendo/flow/wrist_switch.hpp>

#include <array>

namespace nendo::flow {
namespace {

constexpr std::array<std::string_view, 5> action_names{"none", "grab", "commit", "toggle", "keep"};

} // namespace

std::string_view name_of(SwitchAction action) noexcept {
  return action_names[static_cast<std::size_t>(action)];
}

std::optional<SwitchAction> switch_action_named(std::string_view name) noexcept {
  for (std::size_t at = 0; at < action_names.size(); ++at) {
    if (action_names[at] == name) return static_cast<SwitchAction>(at);
  }
  return std::nullopt;
}

bool WristSwitchEdge::turned_on(WristSwitch position, HostTime time) noexcept {
  if (position == WristSwitch::unknown) return false;
  if (settled_ == WristSwitch::unknown) settled_ = position;
  if (position == settled_) {
    differs_since_.reset();
    return false;
  }
  if (!differs_since_) {
    differs_since_ = time;
    return false;
  }
  if (time - *differs_since_ < settling_time) return false;
  settled_ = position;
  differs_since_.reset();
  return is_on();
}

} // namespace nendo::flow
