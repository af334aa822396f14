#include "timeline/timeline.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numbers>

#include <nendo/flow/pacer.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::timeline {
namespace {

constexpr double max_angle_rad = 2.0 * std::numbers::pi;
constexpr double min_positive = 1e-100;
constexpr double largest = 1e100; // as the solver takes

bool within(double value, double least, double most) noexcept {
  return value >= least && value <= most; // false for NaN
}

bool is_place(const Eigen::Vector3d& place_m) noexcept {
  return (place_m.array().abs() <= farthest_m).all(); // false for NaN
}

std::string complaint_about(const HandTrack& track) {
  const std::string whose = std::string(name_of(track.side)) + " hand";
  constexpr double min_hand_m = 0.01;
  if (!within(track.size.length_m, min_hand_m, 1.0) ||
      !within(track.size.breadth_m, min_hand_m, 1.0))
    return whose + ": length and breadth must lie within 0.01 and 1 m";
  for (std::size_t k = 0; k < hand::shape_terms; ++k) {
    const auto term = static_cast<hand::ShapeTerm>(k);
    const double most = hand::max_of(term);
    if (!within(track.size.shape[term], -most, most))
      return whose + ": shape: " + std::string(hand::name_of(term)) + " must lie within " +
             std::to_string(-most) + " and " + std::to_string(most);
  }
  if (track.keys.empty()) return whose + ": has no key; a hand needs one at least";
  if (track.keys.size() > max_keys)
    return whose + ": has more than " + std::to_string(max_keys) + " keys";
  for (std::size_t at = 0; at < track.keys.size(); ++at) {
    std::string wrong = complaint_about(track.keys[at]);
    if (wrong.empty() && at > 0 && !(track.keys[at].time_s > track.keys[at - 1].time_s))
      wrong = "its time must be after that of the key before";
    if (!wrong.empty()) return whose + ", key " + std::to_string(at) + ": " + wrong;
  }
  return {};
}

std::string complaint_about(const flow::SculptorOptions& sculptor, Eigen::Index points) {
  const auto& options = sculptor.deformer;
  if (!within(sculptor.piece_length, min_positive, largest)) return "piece_length must be positive";
  flow::LoopSettings settings = flow::plain_settings_of(sculptor);
  settings.radius_m.fill(1.0);
  if (const auto fine = flow::check_ranges(settings); !fine) return fine.error().message;
  if (options.supports.shared.empty() || !options.supports.are_usable())
    return "supports: radii and weights must be positive, and one at least must be shared";
  for (const auto& own : options.supports.own)
    if (own.point < 0 || own.point >= points)
      return "supports: there is no fingertip, or point of a puppet, " + std::to_string(own.point);
  if (!within(options.csrbf.merge_fraction, 0.0, 1.0))
    return "merge_fraction must lie within 0 and 1";
  constexpr std::size_t max_weight_bytes = std::size_t{1} << 28;
  if (options.evaluation.weight_bytes > max_weight_bytes)
    return "weight_bytes must be at most " + std::to_string(max_weight_bytes);
  if (!options.injective) return {};
  constexpr int max_links = 1024;
  if (!within(options.injective->max_bound, 0.01, 0.999) || options.injective->max_links < 1 ||
      options.injective->max_links > max_links || !within(options.injective->min_gap, 0.0, 1.0))
    return "injective: most_bound must lie within 0.01 and 0.999, most_links within 1 and 1024, "
           "least_gap within 0 and 1";
  return {};
}

/// The complaint about a puppet's command; empty for all other commands.
std::string complaint_about(const flow::Command& command, const puppet::Rig* rig) {
  if (!flow::is_for_puppet(command)) return {};
  if (rig == nullptr) return "is about a puppet, and there is none";
  if (const auto* clutch = std::get_if<flow::SetClutch>(&command);
      clutch != nullptr && clutch->finger > puppet::HandSignal::no_finger &&
      clutch->finger != puppet::RigPlayer::all_fingers)
    return "there is no finger " + std::to_string(clutch->finger);
  if (const auto* role = std::get_if<flow::SetRole>(&command);
      role != nullptr && role->function >= rig->puppet().functions.size())
    return "the puppet has no function " + std::to_string(role->function);
  return {};
}

/// The complaint about a change of the model's parts; empty for all other commands.
std::string complaint_about_parts(const flow::Command& command, const Timeline& timeline) {
  const auto* change = std::get_if<flow::ChangeModel>(&command);
  const auto* edit = std::get_if<flow::EditPart>(&command);
  const auto* join = std::get_if<flow::JoinParts>(&command);
  if (change == nullptr && edit == nullptr && join == nullptr &&
      !std::holds_alternative<flow::ChangeTopology>(command))
    return {};
  if (change != nullptr && change->source != flow::ModelSource::cut)
    return "is none that a timeline can have";
  if (change != nullptr && change->number >= timeline.wires.size())
    return "there is no wire " + std::to_string(change->number);
  if (edit != nullptr && edit->part == deform::no_index) return "must name a part";
  if (join != nullptr && !within(join->seam_width, 0.0, largest))
    return "the seam must be 0 or wider";
  return {};
}

std::string complaint_about(const std::vector<std::vector<deform::WirePlace>>& wires) {
  for (std::size_t at = 0; at < wires.size(); ++at) {
    const std::string which = "wire " + std::to_string(at) + ": ";
    if (wires[at].size() < 2 || wires[at].size() > flow::WirePath::max_places)
      return which + "must have 2 to " + std::to_string(flow::WirePath::max_places) + " places";
    for (const deform::WirePlace& place : wires[at])
      if (!(place.from.cwiseAbs().maxCoeff() <= largest) ||
          !(place.to.cwiseAbs().maxCoeff() <= largest))
        return which + "its places must be finite";
  }
  return {};
}

std::string complaint_about(const Event& event, const Timeline& timeline) {
  const puppet::Rig* const rig = timeline.rig.get();
  const flow::Command& command = event.command;
  if (!within(event.time_s, 0.0, longest_s)) return "its time must lie within 0 and 1000000 s";
  if (const auto* change = std::get_if<flow::ChangeSettings>(&command))
    if (const auto fine = flow::check_ranges(change->settings); !fine) return fine.error().message;
  const bool is_known = std::holds_alternative<flow::Request>(command) ||
                        std::holds_alternative<flow::ChangeSettings>(command) ||
                        changes_model(command) || std::holds_alternative<flow::Mark>(command) ||
                        flow::is_for_puppet(command);
  if (const auto* change = std::get_if<flow::ChangePuppet>(&command))
    return change->number < std::max<std::size_t>(timeline.masks.size(), 1)
               ? ""
               : "there are no such masks";
  if (std::string wrong = complaint_about_parts(command, timeline); !wrong.empty()) return wrong;
  return is_known ? complaint_about(command, rig) : "is none that a timeline can have";
}

std::string complaint_about(const std::vector<Event>& events, const Timeline& timeline) {
  if (events.size() > max_events) return "has more than " + std::to_string(max_events) + " events";
  for (std::size_t at = 0; at < events.size(); ++at) {
    std::string wrong = complaint_about(events[at], timeline);
    if (wrong.empty() && at > 0 && events[at].time_s < events[at - 1].time_s)
      wrong = "its time must not be before that of the event before";
    if (!wrong.empty()) return "event " + std::to_string(at) + ": " + wrong;
  }
  return {};
}

std::string complaint_about(const puppet::Rig* rig, const puppet::RigState& state) {
  if (state.functions.size() != (rig == nullptr ? 0 : rig->puppet().functions.size()))
    return "the puppet must have a state for each of its functions";
  if (rig != nullptr && !rig->starts().allFinite()) return "the puppet's points must be finite";
  for (const puppet::FunctionState& function : state.functions)
    if (!within(function.asked, -largest, largest))
      return "the puppet: what is asked of a function must be finite";
  return {};
}

std::string words_of(const flow::SetClutch& clutch) {
  std::string who(clutched_name(clutch.finger));
  if (clutch.finger == puppet::RigPlayer::all_fingers)
    who = "hand";
  else if (clutch.finger == puppet::HandSignal::no_finger)
    who = "palm and wrist";
  else if (clutch.finger > 0)
    who += " finger";
  return "the " + std::string(name_of(clutch.side)) + " " + who +
         (clutch.holds ? " grabs" : " releases");
}

} // namespace

Eigen::Isometry3d Key::wrist_pose() const noexcept {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = wrist_turn.normalized().toRotationMatrix();
  pose.translation() = wrist_m;
  return pose;
}

bool same_bits(double one, double other) noexcept {
  return std::bit_cast<std::uint64_t>(one) == std::bit_cast<std::uint64_t>(other);
}

bool same_bits(const Key& one, const Key& other) noexcept {
  bool equal = same_bits(one.time_s, other.time_s);
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    equal = equal && same_bits(one.angles[hand::angle_at(at)], other.angles[hand::angle_at(at)]);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    equal = equal && same_bits(one.wrist_m[axis], other.wrist_m[axis]);
  for (Eigen::Index part = 0; part < 4; ++part)
    equal = equal && same_bits(one.wrist_turn.coeffs()[part], other.wrist_turn.coeffs()[part]);
  return equal;
}

bool same_bits(const Event& one, const Event& other) noexcept {
  return same_bits(one.time_s, other.time_s) && one.command == other.command;
}

bool same_bits(const puppet::FunctionState& one, const puppet::FunctionState& other) noexcept {
  return same_bits(one.asked, other.asked) && one.input == other.input && one.held == other.held;
}

puppet::RigState first_state(const puppet::Rig& rig) {
  puppet::RigState state;
  for (const puppet::Function& function : rig.puppet().functions)
    state.functions.push_back({0.0, function.input, true});
  return state;
}

std::string_view clutched_name(std::uint8_t finger) noexcept {
  if (finger < hand::finger_count) return hand::name_of(static_cast<hand::Finger>(finger));
  return finger == puppet::HandSignal::no_finger ? "palm" : "all";
}

std::optional<std::uint8_t> clutched_named(std::string_view name) noexcept {
  for (std::uint8_t finger = 0; finger <= puppet::HandSignal::no_finger; ++finger)
    if (clutched_name(finger) == name) return finger;
  if (name == "all") return puppet::RigPlayer::all_fingers;
  return std::nullopt;
}

bool changes_model(const flow::Command& command) noexcept {
  return flow::model_asked_by(command) || std::holds_alternative<flow::ChangeModel>(command);
}

/// The words of a change of the model.
static std::string words_of_model(const flow::Command& command) {
  if (const auto* refine = std::get_if<flow::Refine>(&command))
    return "refine up to " + std::to_string(refine->max_vertices) + " vertices";
  if (std::holds_alternative<flow::ChangeModel>(command)) return "cut";
  if (std::holds_alternative<flow::JoinParts>(command)) return "join";
  if (std::holds_alternative<flow::ChangeTopology>(command)) return "topology";
  if (const auto* edit = std::get_if<flow::EditPart>(&command))
    return (edit->removes ? "remove part " : "copy part ") + std::to_string(edit->part);
  return "subdivide";
}

std::string in_words(const Timeline& timeline, const Event& event) {
  if (const auto* request = std::get_if<flow::Request>(&event.command))
    return std::string(name_of(*request));
  if (const auto* change = std::get_if<flow::ChangeSettings>(&event.command))
    return flow::in_words(change->settings, timeline.units_per_metre);
  if (const auto* clutch = std::get_if<flow::SetClutch>(&event.command)) return words_of(*clutch);
  if (const auto* role = std::get_if<flow::SetRole>(&event.command); role && timeline.rig)
    return timeline.rig->puppet().functions[role->function].name + " listens to " +
           role->input.name();
  if (const auto* symmetry = std::get_if<flow::SetSymmetry>(&event.command))
    return symmetry->on ? "one hand plays both sides" : "each hand plays its side";
  if (const auto* change = std::get_if<flow::ChangePuppet>(&event.command)) {
    const puppet::Rig* const masks = timeline.masks_numbered(change->number);
    const std::size_t count = masks == nullptr ? 0 : masks->puppet().masks.size();
    return std::to_string(count) + (count == 1 ? " mask" : " masks") +
           (count > 0 && masks->puppet().inverted ? ", inverted" : "") +
           (flow::mirror_of(masks) ? ", symmetric" : "");
  }
  return changes_model(event.command) ? words_of_model(event.command) : "mark";
}

HandTrack* Timeline::track(Side side) noexcept {
  const auto found = std::ranges::find(hands, side, &HandTrack::side);
  return found == hands.end() ? nullptr : &*found;
}

const HandTrack* Timeline::track(Side side) const noexcept {
  const auto found = std::ranges::find(hands, side, &HandTrack::side);
  return found == hands.end() ? nullptr : &*found;
}

std::size_t Timeline::key_count() const noexcept {
  std::size_t count = 0;
  for (const auto& hand : hands)
    count += hand.keys.size();
  return count;
}

Eigen::Index Timeline::point_count() const noexcept {
  return flow::supported_points(rig ? rig.get() : masks_numbered(0),
                                static_cast<Eigen::Index>(hands.size()));
}

std::string complaint_about(const Key& key) {
  if (!within(key.time_s, 0.0, longest_s)) return "its time must lie within 0 and 1000000 s";
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (!within(key.angles[hand::angle_at(at)], -max_angle_rad, max_angle_rad))
      return std::string(hand::angle_names[at]) + " must lie within a full turn either way";
  if (!is_place(key.wrist_m)) return "the wrist must be within 1000 m of the stage's middle";
  if (!within(key.wrist_turn.norm(), 0.99, 1.01))
    return "wrist_turn must be a quaternion of unit length";
  return {};
}

std::string complaint_about(const Timeline& timeline) {
  if (!within(timeline.units_per_metre, min_positive, largest))
    return "units_per_metre must be positive";
  if (!within(timeline.rate_hz, flow::TickGrid::min_rate_hz, flow::TickGrid::max_rate_hz))
    return "rate_hz must lie within 1 and 10000";
  if (!within(timeline.duration_s, 0.0, longest_s))
    return "duration_s must lie within 0 and 1000000";
  if (timeline.hands.empty() || timeline.hands.size() > 2 ||
      (timeline.hands.size() == 2 && timeline.hands[0].side == timeline.hands[1].side))
    return "must have one or two hands, of different sides";
  for (const auto& hand : timeline.hands)
    if (auto wrong = complaint_about(hand); !wrong.empty()) return wrong;
  if (auto wrong = complaint_about(timeline.sculptor, timeline.point_count()); !wrong.empty())
    return wrong;
  if (flow::is_by_hands(timeline.sculptor.mode) &&
      flow::is_played(timeline.rig ? timeline.rig.get() : timeline.masks_numbered(0)))
    return "puppets neither press clay nor move parts; use mode type1 or type2";
  if (auto wrong = complaint_about(timeline.rig.get(), timeline.rig_state); !wrong.empty())
    return wrong;
  if (timeline.rig && !timeline.masks.empty()) return "a puppet's masks are in its own text";
  for (const auto& masks : timeline.masks)
    if (flow::is_played(masks.get())) return "masks must have no points";
  if (std::string wrong = complaint_about(timeline.wires); !wrong.empty()) return wrong;
  return complaint_about(timeline.events, timeline);
}

namespace {

std::size_t index_in(const std::vector<Key>& keys, std::vector<Key>::const_iterator key) noexcept {
  return static_cast<std::size_t>(key - keys.begin());
}

} // namespace

const Key* find_key(const Timeline& timeline, const KeyRef& key) noexcept {
  const HandTrack* const track = timeline.track(key.side);
  return track == nullptr || key.key >= track->keys.size() ? nullptr : &track->keys[key.key];
}

std::optional<KeyRef> key_at(const Timeline& timeline, Side side, double time_s) noexcept {
  const HandTrack* const track = timeline.track(side);
  if (track == nullptr) return std::nullopt;
  const auto found = std::ranges::lower_bound(track->keys, time_s, {}, &Key::time_s);
  if (found == track->keys.end() || found->time_s != time_s) return std::nullopt;
  return KeyRef{side, index_in(track->keys, found)};
}

std::optional<KeyRef> key_after(const Timeline& timeline, double time_s,
                                std::optional<Side> side) noexcept {
  std::optional<KeyRef> nearest;
  for (const HandTrack& hand : timeline.hands) {
    if (side && hand.side != *side) continue;
    const auto found = std::ranges::upper_bound(hand.keys, time_s, {}, &Key::time_s);
    if (found == hand.keys.end()) continue;
    if (!nearest || found->time_s < find_key(timeline, *nearest)->time_s)
      nearest = KeyRef{hand.side, index_in(hand.keys, found)};
  }
  return nearest;
}

std::optional<KeyRef> key_before(const Timeline& timeline, double time_s,
                                 std::optional<Side> side) noexcept {
  std::optional<KeyRef> nearest;
  for (const HandTrack& hand : timeline.hands) {
    if (side && hand.side != *side) continue;
    const auto after = std::ranges::lower_bound(hand.keys, time_s, {}, &Key::time_s);
    if (after == hand.keys.begin()) continue;
    if (!nearest || (after - 1)->time_s > find_key(timeline, *nearest)->time_s)
      nearest = KeyRef{hand.side, index_in(hand.keys, after - 1)};
  }
  return nearest;
}

} // namespace nendo::timeline
