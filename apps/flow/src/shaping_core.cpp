#include <nendo/flow/shaping_core.hpp>

#include <utility>

#include <nendo/flow/command.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/wire_path.hpp>
#include <nendo/hand/held_points.hpp>

namespace nendo::flow {

using deform::Points;

namespace {

using Eigen::Vector3d;

Vector3d place_of(const puppet::HandState& hand, hand::Joint joint) {
  return hand.pose[joint].translation();
}

/// From the tip on, by that length, m.
deform::WirePlace knife_of(const puppet::HandState& hand, double length_m) {
  const Vector3d tip = place_of(hand, hand::Joint::index_tip);
  const Vector3d way = tip - place_of(hand, hand::Joint::index_proximal);
  return {tip, tip + length_m * way.normalized()};
}

/// 1: the index finger is straight.
double straightness_of(const puppet::HandState& hand) {
  using hand::Joint;
  double length = 0.0;
  for (const auto& [from, to] : {std::pair{Joint::index_proximal, Joint::index_intermediate},
                                 {Joint::index_intermediate, Joint::index_distal},
                                 {Joint::index_distal, Joint::index_tip}})
    length += (place_of(hand, to) - place_of(hand, from)).norm();
  return (place_of(hand, Joint::index_tip) - place_of(hand, Joint::index_proximal)).norm() / length;
}

/// Symmetry adds the images of all points.
Eigen::Index points_at_first(const CoreOptions& options) {
  SculptorOptions sculptor = options.setup.options;
  sculptor.mirror = mirror_of(options.rig.get());
  return control_points_of(options.rig.get(), sculptor,
                           static_cast<Eigen::Index>(options.hands.size()));
}

/// Makes the second half of the points the mirror images of the first.
void mirror_half(double at, Points& points) noexcept {
  const Eigen::Index half = points.cols() / 2;
  for (Eigen::Index point = 0; point < half; ++point) {
    points.col(half + point) = points.col(point);
    points(0, half + point) = 2.0 * at - points(0, point);
  }
}

} // namespace

/// The wire or knife that hands draw through the model. It does not allocate.
class DrawnBlade {
public:
  using Hands = puppet::RigPlayer::Hands;

  explicit DrawnBlade(double units_per_metre) noexcept : units_per_metre_(units_per_metre) {}

  void begin(Blade blade) noexcept;
  void end() noexcept;
  void clear() noexcept { path_.clear(); }
  /// Moves the blade with the hands, on the stage, while it is drawn. A knife is `knife_m` long. A
  /// wire is between both index fingertips, or between thumb and index finger of the only hand. A
  /// knife is held by the hand that points more when its path begins.
  void follow(const Hands& hands, double knife_m) noexcept;

  bool is_drawing() const noexcept { return path_.is_drawing(); }
  const WirePath& path() const noexcept {
    return path_;
  } ///< the path of the current blade, or of the last one
  const WirePath& completed() const noexcept { return completed_; } ///< the last complete path

private:
  double units_per_metre_;
  WirePath path_;
  WirePath completed_;
  Blade blade_ = Blade::wire;
  bool knife_in_right_ = true; ///< hand
};

void DrawnBlade::begin(Blade blade) noexcept {
  constexpr double step_m = 0.002;
  path_.begin(step_m * units_per_metre_);
  blade_ = blade;
}

void DrawnBlade::end() noexcept {
  const std::uint32_t before = path_.completed();
  path_.end();
  if (path_.completed() != before) completed_ = path_;
}

void DrawnBlade::follow(const Hands& hands, double knife_m) noexcept {
  if (!path_.is_drawing()) return;
  const auto& [left, right] = hands;
  const puppet::HandState& one = left != nullptr ? *left : *right;
  const bool has_both = left != nullptr && right != nullptr;
  deform::WirePlace place{place_of(one, hand::Joint::thumb_tip),
                          place_of(one, hand::Joint::index_tip)};
  if (blade_ == Blade::knife) {
    if (path_.places().empty())
      knife_in_right_ =
          left == nullptr || (has_both && straightness_of(*right) >= straightness_of(*left));
    place = knife_of(knife_in_right_ ? *right : *left, knife_m);
  } else if (has_both) {
    place = {place_of(*left, hand::Joint::index_tip), place_of(*right, hand::Joint::index_tip)};
  }
  path_.draw_to({units_per_metre_ * place.from, units_per_metre_ * place.to});
}

ShapingCore::ShapingCore(ChangeBroker& changes, const CoreOptions& options)
    : units_per_metre_(options.units_per_metre), hands_(options.hands), bodies_(options.bodies),
      mirror_(mirror_of(options.rig.get())), tips_(Points::Zero(3, points_at_first(options))),
      shaping_(changes.first_model(), changes.setup(), tips_.cols(), options.shaping),
      blade_(std::make_unique<DrawnBlade>(units_per_metre_)) {
  if (!is_played(options.rig.get())) return;
  puppet_.emplace(options.rig);
  puppet_->player().set_state(options.rig_state);
}

ShapingCore::~ShapingCore() = default;

Frame ShapingCore::first_frame() const {
  Frame frame;
  frame.settings = shaping_.settings();
  frame.units_per_metre = units_per_metre_;
  frame.shape = shaping_.sculptor().rest();
  frame.fields = shaping_.sculptor().fields();
  frame.surface.vectors.setZero(3, puppet_ ? 2 * tips_.cols() : 0);
  for (auto& hand : frame.hands)
    hand.pose.joints.fill(Eigen::Isometry3d::Identity());
  return frame;
}

deform::FieldStatus ShapingCore::begin(const Hands& hands, Frame& frame) noexcept {
  if (puppet_) puppet_->player().regrab(hands);
  place(hands, std::nullopt, true, frame);
  const deform::FieldStatus status = shaping_.begin(tips_);
  keep_held_values();
  return status;
}

void ShapingCore::apply(const Command& command, const Hands& hands) noexcept {
  if (puppet_ && command == Command(Request::regrab)) return puppet_->player().regrab(hands);
  if (const auto* request = std::get_if<Request>(&command)) return shaping_.ask(*request);
  if (const auto* wire = std::get_if<DrawWire>(&command)) return draw(*wire);
  if (puppet_ && is_for_puppet(command)) puppet_->apply(command, hands);
}

void ShapingCore::toggle_clutch(Side side, const Hands& hands) noexcept {
  puppet_->player().toggle_clutch(side, hands);
}

/// Hands that draw hold nothing meanwhile.
void ShapingCore::draw(const DrawWire& draw) noexcept {
  if (!draw.on) {
    blade_->end();
    if (std::exchange(holds_after_blade_, false)) shaping_.ask(Request::grab);
    return;
  }
  if (!blade_->is_drawing()) holds_after_blade_ = shaping_.is_held();
  blade_->begin(draw.blade);
  shaping_.ask(Request::release);
}

void ShapingCore::place(const Hands& hands, std::optional<HostTime> time, bool with_bodies,
                        Frame& frame) noexcept {
  if (!puppet_) {
    place_tips(hands, tips_);
    if (with_bodies || is_by_hands(shaping_.sculptor().mode())) place_bodies(hands);
  }
  blade_->follow(hands, shaping_.model().layout().diagonal() / units_per_metre_);
  if (!(frame.wire == blade_->path())) frame.wire = blade_->path();
  if (puppet_) {
    puppet_->play(shaping_.is_held(), hands, time);
    puppet_->player().write(tips_);
  }
  show_puppet(frame);
}

void ShapingCore::place_tips(const Hands& hands, Points& tips) noexcept {
  Eigen::Index column = 0;
  const auto hand_count = static_cast<Eigen::Index>(hands_.size());
  const Eigen::Index points = tips.cols() / ((mirror_ ? 2 : 1) * hand_count);
  for (const Side side : hands_) {
    const hand::HandPose& pose = hands[Placement::index_of(side)]->pose;
    if (points == 5)
      tips.middleCols<5>(column) = units_per_metre_ * pose.fingertip_positions();
    else
      tips.middleCols<static_cast<int>(hand::held_point_count)>(column) =
          units_per_metre_ * hand::held_places(pose);
    column += points;
  }
  if (mirror_) mirror_half(*mirror_, tips);
}

/// Hands that hold still press where they stopped, until they continue.
void ShapingCore::place_bodies(const Hands& hands) noexcept {
  if (shaping_.is_still()) return;
  for (const Side side : hands_) {
    const std::size_t slot = Placement::index_of(side);
    bodies_->follow(bodies_->count() == 2 ? slot : 0, hands[slot]->pose);
  }
}

void ShapingCore::show_puppet(Frame& frame) const noexcept {
  if (!puppet_) {
    frame.released = {};
    frame.symmetric = mirror_.has_value();
    frame.function_count = 0;
    return;
  }
  const puppet::RigPlayer& player = puppet_->player();
  for (const Side side : {Side::left, Side::right})
    frame.released[Placement::index_of(side)] = player.has_released(side);
  frame.symmetric = player.state().symmetric;
  frame.function_count = static_cast<std::uint32_t>(player.values().size());
  for (std::size_t at = 0; at < player.values().size(); ++at)
    frame.functions[at] = static_cast<float>(player.values()[at]);
}

void ShapingCore::shape(HostClock::duration time, bool completes, Frame& frame,
                        LoopStats& stats) noexcept {
  shaping_.set_time(time);
  const std::uint64_t holds = shaping_.sculptor().holds();
  frame.status = shaping_.shape(tips_, frame, stats, completes);
  if (shaping_.sculptor().holds() != holds) keep_held_values();
}

void ShapingCore::finish(PreparedChange& change, const Hands& hands, Frame& frame,
                         LoopStats& stats) noexcept {
  if (change.holds_still) {
    shaping_.hold_still(tips_, frame, stats);
    if (puppet_) puppet_->keep_still_values();
  }
  if (change.settings) place_again(hands);
  if (change.exchanges()) exchange(change, hands, frame, stats);
}

/// A puppet's points stay where they are.
void ShapingCore::place_again(const Hands& hands) noexcept {
  if (puppet_) return puppet_->player().regrab(hands);
  place_tips(hands, tips_);
  place_bodies(hands);
}

void ShapingCore::exchange(PreparedChange& change, const Hands& hands, Frame& frame,
                           LoopStats& stats) noexcept {
  const bool holds_on = shaping_.holds_on(change.ready);
  if (change.rig) take_puppet(*change.rig, change.ready, hands);
  if (puppet_ && shaping_.is_still())
    puppet_->hold_where_stopped();
  else if (!holds_on)
    keep_held_values();
  Points& other_tips = change.ready.tips; // where other points of the hands hold the model
  if (!puppet_ && other_tips.cols() != tips_.cols()) {
    place_tips(hands, other_tips);
    place_bodies(hands);
  }
  change.is_refused = !shaping_.exchange(change.ready, tips_, frame, stats);
  if (shaping_.sculptor().control_points() != tips_.cols()) std::swap(tips_, other_tips);
}

/// The hands have grabbed where they are.
void ShapingCore::keep_held_values() noexcept {
  if (puppet_) puppet_->keep_held_values();
}

/// `rig` then has what was before. If the shape is still held at the values at which the hands
/// grabbed it, these are the starts.
void ShapingCore::take_puppet(ReadyRig& rig, ReadySculptor& ready, const Hands& hands) noexcept {
  if (rig.puppet) {
    rig.puppet->take_over(puppet_ ? &*puppet_ : nullptr, rig.from, hands, ready.starts);
    rig.puppet->player().write(rig.tips);
  }
  std::swap(puppet_, rig.puppet);
  std::swap(mirror_, rig.mirror);
  std::swap(tips_, rig.tips);
  if (!puppet_) place_again(hands);
}

void ShapingCore::restart(LogChange& change, const Hands& hands, Frame& frame,
                          LoopStats& stats) noexcept {
  LoopState& state = change.state;
  if (puppet_) puppet_->reset_gestures();
  place_again(hands);
  blade_->clear();
  holds_after_blade_ = false;
  if (puppet_) state.rig = puppet_->player().state(); // which has memory for it
  shaping_.restart(tips_, change.log != nullptr, frame, stats);
  keep_held_values();
  state.held = shaping_.is_held();
  const deform::BlockShape& rest = shaping_.sculptor().rest();
  if (state.shape.block_count() != rest.block_count())
    std::swap(state.shape, change.of_other_model);
  state.shape.follow(rest);
}

bool ShapingCore::has_clutch(Side side) const noexcept {
  return puppet_ && puppet_->player().rig().puppet().clutch.means[Placement::index_of(side)] ==
                        puppet::ClutchTrigger::wrist_switch;
}

const WirePath& ShapingCore::completed_wire() const noexcept {
  return blade_->completed();
}

} // namespace nendo::flow
