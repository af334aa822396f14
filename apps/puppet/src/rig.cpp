#include <nendo/puppet/rig.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <nendo/base/units.hpp>

namespace nendo::puppet {

using deform::Points;
using Eigen::Index;
using Eigen::Vector3d;

namespace {

Vector3d vector_of(const Function& function, const Move& move, const Vector3d& start) {
  if (!move.part || !function.turn) return move.vector;
  const double turn_rad = from_degrees(function.turn->degrees) * *move.part;
  if (turn_rad == 0.0) return Vector3d::Zero();
  Vector3d axis = function.turn->axis;
  axis.stableNormalize();
  const Vector3d arm = start - function.turn->through;
  return Eigen::AngleAxisd(turn_rad, axis) * arm - arm;
}

constexpr double straight = 0.7; // of the way to a limit, of a function that eases
constexpr double slowing = 1.3;  // of it, where the limit is reached

/// Arrives at the limit with a slope of 0, in place of a corner.
double eased(double value, double limit) noexcept {
  const double part = std::abs(value / limit);
  if (part <= straight) return value;
  const double rest = 1.0 - straight;
  const double over = std::min((part - straight) / (2.0 * rest), 1.0);
  return std::copysign(std::abs(limit) * (straight + rest * over * (2.0 - over)), value);
}

/// A hand that grabs again moves the function at once, however far beyond its limit it was.
double within_reach(const Function& function, double value) noexcept {
  const double reach = function.eases ? slowing : 1.0;
  return std::clamp(value, reach * function.least, reach * function.most);
}

} // namespace

double value_of(const Function& function, double asked) noexcept {
  const double limit = asked < 0.0 ? function.least : function.most;
  if (limit == 0.0) return 0.0;
  return function.eases ? eased(asked, limit) : std::clamp(asked, function.least, function.most);
}

double asked_for(const Function& function, double value) noexcept {
  const double limit = value < 0.0 ? function.least : function.most;
  if (!function.eases || limit == 0.0) return value;
  const double part = std::abs(value / limit);
  if (part <= straight) return value;
  const double rest = 1.0 - straight; // eased(), solved for its argument
  const double over = 1.0 - std::sqrt(std::max(0.0, 1.0 - (part - straight) / rest));
  return std::copysign(std::abs(limit) * (straight + 2.0 * rest * over), value);
}

Rig::Rig(Puppet puppet, const deform::Mesh& model) : puppet_(std::move(puppet)) {
  std::vector<deform::SurfacePosition> places;
  if (puppet_.is_played()) places = positions_on(puppet_, model);
  starts_.resize(3, static_cast<Index>(places.size()));
  for (std::size_t at = 0; at < places.size(); ++at)
    starts_.col(static_cast<Index>(at)) = places[at].in(model.vertices);
  place_vectors();
}

Rig::Rig(Puppet puppet, Points starts) : puppet_(std::move(puppet)), starts_(std::move(starts)) {
  assert(static_cast<std::size_t>(starts_.cols()) == puppet_.points.size());
  place_vectors();
}

void Rig::place_vectors() {
  for (const Function& function : puppet_.functions) {
    Points& vectors = vectors_.emplace_back(Points::Zero(3, starts_.cols()));
    for (const Move& move : function.moves) {
      const auto point = static_cast<Index>(move.point);
      vectors.col(point) += vector_of(function, move, starts_.col(point));
    }
  }
}

void Rig::place(std::span<const double> values, Points& points) const {
  points = starts_;
  for (std::size_t at = 0; at < values.size(); ++at)
    if (values[at] != 0.0) points += values[at] * vectors_[at];
}

deform::Supports Rig::supports() const {
  std::vector<deform::OwnSupport> own;
  for (std::size_t at = 0; at < puppet_.points.size(); ++at)
    for (const deform::Support& support : puppet_.points[at].supports())
      own.push_back({static_cast<Index>(at), support});
  return deform::with_common(std::move(own));
}

std::vector<std::size_t> functions_before(const Puppet& before, const Puppet& after) {
  const auto number_of = [&](const auto& is_it) {
    const auto found = std::ranges::find_if(before.functions, is_it);
    return found == before.functions.end()
               ? no_function
               : static_cast<std::size_t>(found - before.functions.begin());
  };
  std::vector<std::size_t> numbers;
  for (const Function& function : after.functions)
    numbers.push_back(number_of([&](const auto& other) { return other.name == function.name; }));
  for (std::size_t at = 0; at < numbers.size(); ++at) { // with other names
    if (numbers[at] != no_function) continue;
    Function named = after.functions[at];
    const std::size_t number = number_of([&](const Function& other) {
      named.name = other.name;
      return named == other;
    });
    if (std::ranges::find(numbers, number) == numbers.end()) numbers[at] = number;
  }
  return numbers;
}

RigPlayer::RigPlayer(std::shared_ptr<const Rig> rig)
    : rig_(std::move(rig)), holds_(rig_->puppet().functions.size()), values_(holds_.size(), 0.0) {
  const Puppet& puppet = rig_->puppet();
  for (const Function& function : puppet.functions) {
    twins_.push_back(puppet.function_named(twin_of(function.name)).value_or(twins_.size()));
    state_.functions.push_back({0.0, function.input, true});
  }
}

void RigPlayer::regrab(std::size_t function, const Hands& hands) noexcept {
  FunctionState& state = state_.functions[function];
  const HandState* const hand = hands[static_cast<std::size_t>(state.input.side())];
  if (hand == nullptr) return;
  state.asked = within_reach(rig_->puppet().functions[function], state.asked);
  holds_[function] = {state.input.of(*hand), state.asked};
}

void RigPlayer::regrab(const Hands& hands) noexcept {
  for (std::uint32_t& grips : grips_)
    ++grips;
  for (std::size_t at = 0; at < holds_.size(); ++at)
    regrab(at, hands);
}

void RigPlayer::follow(const Hands& hands) noexcept {
  for (std::size_t at = 0; at < holds_.size(); ++at) {
    FunctionState& state = state_.functions[at];
    const HandState* const hand = hands[static_cast<std::size_t>(state.input.side())];
    if (hand == nullptr || !is_held(state)) continue;
    const double moved =
        (state.input.of(*hand) - holds_[at].signal) / rig_->puppet().functions[at].travel;
    state.asked = holds_[at].value + moved;
    const Kept& kept = kept_[static_cast<std::size_t>(state.input.side())];
    if (kept.part > 0.0) state.asked += kept.part * (kept.asked[at] - state.asked);
  }
  set_values();
}

void RigPlayer::set_values() noexcept {
  const auto& functions = rig_->puppet().functions;
  for (std::size_t at = 0; at < values_.size(); ++at)
    values_[at] = value_of(functions[at], state_.functions[at].asked);
  if (!state_.symmetric) return;
  for (std::size_t at = 0; at < values_.size(); ++at)
    if (std::abs(values_[twins_[at]]) > std::abs(values_[at])) values_[at] = values_[twins_[at]];
}

void RigPlayer::set_clutch(Side side, std::uint8_t finger, bool holds,
                           const Hands& hands) noexcept {
  bool& hand_holds = state_.hand_holds[static_cast<std::size_t>(side)];
  ++grips_[static_cast<std::size_t>(side)];
  const bool is_alone = holds && finger != all_fingers && !hand_holds; // of a hand that release
  for (std::size_t at = 0; at < holds_.size(); ++at) {
    FunctionState& state = state_.functions[at];
    if (state.input.side() != side) continue;
    const bool was_held = is_held(state);
    const bool is_meant = finger == all_fingers || finger == state.input.finger();
    if (is_meant && (holds || finger != all_fingers)) state.held = holds;
    if (!is_meant && is_alone) state.held = false;
    if (is_meant && was_held != holds) regrab(at, hands);
  }
  if (finger == all_fingers || is_alone) hand_holds = holds;
}

void RigPlayer::toggle_clutch(Side side, const Hands& hands) noexcept {
  bool& hand_holds = state_.hand_holds[static_cast<std::size_t>(side)];
  if (hand_holds && has_released(side)) return set_clutch(side, all_fingers, true, hands);
  hand_holds = !hand_holds;
  ++grips_[static_cast<std::size_t>(side)];
  for (std::size_t at = 0; at < holds_.size(); ++at)
    if (state_.functions[at].input.side() == side && state_.functions[at].held) regrab(at, hands);
}

void RigPlayer::set_kept(Side side, double part, std::span<const double> kept) noexcept {
  kept_[static_cast<std::size_t>(side)] = {part, kept};
}

void RigPlayer::set_input(std::size_t function, HandSignal input, const Hands& hands) noexcept {
  if (function >= holds_.size()) return;
  state_.functions[function].input = input;
  regrab(function, hands);
}

void RigPlayer::set_symmetric(bool on) noexcept {
  state_.symmetric = on;
  set_values();
}

void RigPlayer::remember(const RigPlayer& earlier) {
  if (earlier.holds_.size() != holds_.size()) return;
  state_.functions = earlier.state_.functions;
  holds_ = earlier.holds_;
  known_ = earlier.grips_;
}

void RigPlayer::continue_from(const RigPlayer& before, std::span<const std::size_t> from,
                              const Hands& hands) noexcept {
  const auto& functions = rig_->puppet().functions;
  for (std::size_t at = 0; at < holds_.size() && at < from.size(); ++at) {
    FunctionState& state = state_.functions[at];
    if (from[at] < before.holds_.size()) {
      const Function& was = before.rig_->puppet().functions[from[at]];
      const HandSignal input = state.input;
      state = before.state_.functions[from[at]];
      const HandSignal played = state.input;
      if (was.input != input) state.input = input;
      holds_[at] = before.holds_[from[at]];
      if (state.input == played && was.travel == functions[at].travel) continue;
    } else if (known_) {
      const auto slot = static_cast<std::size_t>(state.input.side());
      if ((*known_)[slot] == before.grips_[slot]) continue;
    }
    regrab(at, hands);
  }
  state_.symmetric = before.state_.symmetric;
  state_.hand_holds = before.state_.hand_holds;
  grips_ = before.grips_;
  known_.reset();
  set_values();
}

bool RigPlayer::has_released(Side side) const noexcept {
  return std::ranges::none_of(state_.functions, [&](const auto& state) {
    return state.input.side() == side && is_held(state);
  });
}

void RigPlayer::set_state(const RigState& state) noexcept {
  if (state.functions.size() != holds_.size()) return;
  std::ranges::copy(state.functions, state_.functions.begin());
  state_.symmetric = state.symmetric;
  state_.hand_holds = state.hand_holds;
  set_values();
}

} // namespace nendo::puppet
