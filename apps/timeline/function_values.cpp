#include "timeline/function_values.hpp"

#include <utility>

namespace nendo::timeline {
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
      : timeline_(timeline), hands_(timeline), is_held_(timeline.held), will_hold_(is_held_) {
    for (const HandTrack& track : timeline.hands)
      tracks_.push_back({track.side, track.skeleton(), HandCurve(track.keys)});
    pose(hands_, 0.0);
    hands_.take_hold();
  }

  /// Makes the frame of that time, with all that is due until then.
  void make_frame(double time_s, double due_until_s) {
    bool takes_hold = false;
    for (; next_ < timeline_.events.size() && timeline_.events[next_].time_s <= due_until_s;
         ++next_)
      takes_hold = ask(timeline_.events[next_].command) || takes_hold;
    pose(hands_, time_s);
    hands_.play(is_held_, time_of(time_s));
    is_held_ = will_hold_;
    if (takes_hold) hands_.take_hold();
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
  struct Track {
    Side side;
    hand::HandSkeleton skeleton;
    HandCurve curve;
  };

  /// Returns true if the functions re-grab at the end of the frame.
  bool ask(const flow::Command& command) {
    hands_.apply(command);
    if (const auto* request = std::get_if<flow::Request>(&command)) {
      if (*request == flow::Request::grab) will_hold_ = true;
      if (*request == flow::Request::let_go) will_hold_ = false;
    }
    return std::holds_alternative<flow::ChangeSettings>(command);
  }

  void pose(PuppetHands& hands, double time_s) const {
    for (const Track& track : tracks_) {
      const Key key = track.curve.at(time_s);
      const Eigen::Isometry3d T_stage_wrist = key.wrist_pose();
      hands.pose(track.side,
                 {key.angles, track.skeleton.pose(key.angles, T_stage_wrist), T_stage_wrist});
    }
  }

  const Timeline& timeline_;
  std::vector<Track> tracks_;
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
  if (command == flow::Command(flow::Request::take_hold)) take_hold();
}

double PuppetHands::signal(const puppet::HandSignal& input) const noexcept {
  const auto& hand = states_[static_cast<std::size_t>(input.side())];
  return hand ? input.of(*hand) : 0.0;
}

} // namespace nendo::timeline
