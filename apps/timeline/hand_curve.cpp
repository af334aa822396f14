#include "timeline/hand_curve.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace nendo::timeline {
namespace {

template <class AnyKey>
auto& channel(AnyKey& key, std::size_t at) noexcept {
  return at < hand::angle_count ? key.angles[hand::angle_at(at)]
                                : key.wrist_m[static_cast<Eigen::Index>(at - hand::angle_count)];
}

} // namespace

HandCurve::HandCurve(std::vector<Key> keys) : keys_(std::move(keys)), slopes_(keys_.size()) {
  assert(!keys_.empty());
  for (std::size_t key = 0; key < keys_.size(); ++key)
    for (std::size_t at = 0; at < channel_count; ++at)
      slopes_[key][at] = slope(key, at);
}

double HandCurve::secant(std::size_t interval, std::size_t at) const noexcept {
  const Key& begin = keys_[interval];
  const Key& end = keys_[interval + 1];
  return (channel(end, at) - channel(begin, at)) / (end.time_s - begin.time_s);
}

double HandCurve::slope(std::size_t key, std::size_t at) const noexcept {
  if (keys_.size() == 1) return 0.0;
  if (key == 0) return secant(0, at);
  if (key + 1 == keys_.size()) return secant(key - 1, at);
  const double before = secant(key - 1, at);
  const double after = secant(key, at);
  if (!(before * after > 0.0)) return 0.0; // a turn, or a rest
  const double length = keys_[key].time_s - keys_[key - 1].time_s;
  const double next_length = keys_[key + 1].time_s - keys_[key].time_s;
  const double weight_before = length + 2.0 * next_length;
  const double weight_after = 2.0 * length + next_length;
  return (weight_before + weight_after) / (weight_before / before + weight_after / after);
}

Key HandCurve::at(double time_s) const noexcept {
  const auto after = std::ranges::upper_bound(keys_, time_s, {}, &Key::time_s);
  const auto held = [time_s](Key key) {
    key.time_s = time_s;
    return key;
  };
  if (after == keys_.begin()) return held(keys_.front());
  if (after == keys_.end() || (after - 1)->time_s == time_s) return held(*(after - 1));
  const Key& begin = *(after - 1);
  const Key& end = *after;
  const auto index = static_cast<std::size_t>(after - keys_.begin()) - 1;
  const double length = end.time_s - begin.time_s;
  const double t = (time_s - begin.time_s) / length;
  const double to_end = t * t * (3.0 - 2.0 * t);
  const double bulge_begin = t * (1.0 - t) * (1.0 - t) * length;
  const double bulge_end = t * t * (t - 1.0) * length;
  Key key;
  key.time_s = time_s;
  for (std::size_t at = 0; at < channel_count; ++at) {
    const double from = channel(begin, at);
    const double to = channel(end, at);
    const double value = from + (to - from) * to_end + bulge_begin * slopes_[index][at] +
                         bulge_end * slopes_[index + 1][at];
    channel(key, at) = std::clamp(value, std::min(from, to), std::max(from, to)); // of rounding
  }
  key.wrist_turn = begin.wrist_turn.normalized().slerp(t, end.wrist_turn.normalized());
  return key;
}

puppet::HandState MovingHand::at(double time_s) const noexcept {
  const Key key = curve.at(time_s);
  const Eigen::Isometry3d T_stage_wrist = key.wrist_pose();
  return {key.angles, skeleton.pose(key.angles, T_stage_wrist), T_stage_wrist};
}

namespace {

/// Of a frame; gestures are seen from the second one on, as by Player.
std::optional<HostTime> time_of(double time_s) {
  if (!(time_s > 0.0)) return std::nullopt;
  return HostTime{} + from_seconds(time_s);
}

/// A Player without a model.
class FunctionPlayer {
public:
  explicit FunctionPlayer(const Timeline& timeline)
      : timeline_(timeline), moving_(timeline.hands.begin(), timeline.hands.end()),
        hands_(timeline), is_held_(timeline.held), will_hold_(is_held_) {
    pose(hands_, 0.0);
    hands_.regrab();
  }

  /// Makes the frame of that time, with all that is due until then.
  void make_frame(double time_s, double due_until_s) {
    bool regrabs = false;
    for (; next_ < timeline_.events.size() && timeline_.events[next_].time_s <= due_until_s;
         ++next_)
      regrabs = ask(timeline_.events[next_].command) || regrabs;
    pose(hands_, time_s);
    hands_.play(is_held_, time_of(time_s));
    is_held_ = will_hold_;
    if (regrabs) hands_.regrab();
  }

  /// Returns the functions at a time between the last frame and the next one.
  PuppetHands at(double time_s) const {
    PuppetHands hands = hands_;
    pose(hands, time_s);
    hands.play(is_held_, time_of(time_s));
    return hands;
  }
  bool is_held() const noexcept { return is_held_; }

private:
  /// Returns true if the functions re-grab at the end of the frame.
  bool ask(const flow::Command& command) {
    hands_.apply(command);
    if (const auto* request = std::get_if<flow::Request>(&command)) {
      if (*request == flow::Request::grab) will_hold_ = true;
      if (*request == flow::Request::release) will_hold_ = false;
    }
    return std::holds_alternative<flow::ChangeSettings>(command);
  }

  void pose(PuppetHands& hands, double time_s) const {
    for (const MovingHand& hand : moving_)
      hands.pose(hand.skeleton.side(), hand.at(time_s));
  }

  const Timeline& timeline_;
  std::vector<MovingHand> moving_;
  PuppetHands hands_;
  bool is_held_;   ///< the hands hold the model
  bool will_hold_; ///< from the next frame on
  std::size_t next_ = 0;
};

} // namespace

void play_functions(const Timeline& timeline, std::span<const double> times_s,
                    const std::function<void(std::size_t, const PuppetMoment&)>& see) {
  const double hair_s = 1e-6 / timeline.rate_hz; // what is so near belongs to a frame, as in Player
  FunctionPlayer player(timeline);
  const auto frames =
      static_cast<std::uint64_t>((timeline.duration_s + hair_s) * timeline.rate_hz) + 1;
  std::size_t at = 0;
  for (std::uint64_t frame = 0; frame < frames && at < times_s.size(); ++frame) {
    const bool is_last = frame + 1 == frames;
    const double time_s = static_cast<double>(frame) / timeline.rate_hz;
    const double next_s = static_cast<double>(frame + 1) / timeline.rate_hz;
    player.make_frame(time_s, is_last ? longest_s : time_s + hair_s);
    for (; at < times_s.size() && (is_last || times_s[at] < next_s - hair_s); ++at)
      see(at, {player.at(times_s[at]), player.is_held()});
  }
}

PuppetHands::PuppetHands(const Timeline& timeline) : puppet_(timeline.rig) {
  puppet_.player().set_state(timeline.rig_state);
}

void PuppetHands::pose(Side side, const puppet::HandState& hand) {
  states_[static_cast<std::size_t>(side)] = hand;
}

puppet::RigPlayer::Hands PuppetHands::hands() const noexcept {
  puppet::RigPlayer::Hands hands{};
  for (std::size_t side = 0; side < states_.size(); ++side)
    hands[side] = states_[side] ? &*states_[side] : nullptr;
  return hands;
}

void PuppetHands::apply(const flow::Command& command) noexcept {
  if (flow::is_for_puppet(command)) puppet_.apply(command, hands());
  if (command == flow::Command(flow::Request::regrab)) regrab();
}

double PuppetHands::signal(const puppet::HandSignal& input) const noexcept {
  const auto& hand = states_[static_cast<std::size_t>(input.side())];
  return hand ? input.of(*hand) : 0.0;
}

} // namespace nendo::timeline
