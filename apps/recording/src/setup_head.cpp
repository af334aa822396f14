#include "setup_parts.hpp"

#include <type_traits>
#include <utility>

#include <nendo/flow/setting.hpp>

namespace nendo::recording {
namespace {

constexpr double largest = 1e6; // of all numbers that describe a hand
constexpr double min_hand_m = 0.01;
constexpr double max_hand_m = 1.0;

void bounded(auto& fields, auto& value) {
  fields.number(value, -largest, largest);
}

void line_fields(auto& fields, auto& line) {
  bounded(fields, line.gain_rad_per_count);
  bounded(fields, line.offset_counts);
}

void calibration_fields(auto& fields, auto& calibration) {
  for (auto& line : calibration.sensors)
    line_fields(fields, line);
  for (auto& part : calibration.coupling_gains)
    bounded(fields, part);
  bounded(fields, calibration.middle_bias);
}

/// RangeAdaptation judges whether such ranges can have been learned.
void learned_fields(auto& fields, auto& learned) {
  fields.one_of(learned.side, Side::right);
  for (auto& sensor : learned.sensors) {
    bounded(fields, sensor.low_counts);
    bounded(fields, sensor.high_counts);
    fields.u32(sensor.bottoms);
    fields.u32(sensor.tops);
    line_fields(fields, sensor.line);
  }
}

/// Added to the kind of a hand's filter if its wearer's ends follow.
constexpr unsigned ends_bit = 64;

void filter_fields(auto& fields, auto& filter) {
  flow::for_each_filter_number(
      [&](const flow::NumberSetting& number) { bounded(fields, number.of(filter)); });
}

/// SlipAdaptation judges whether sensors can have such ends.
void ends_fields(auto& fields, auto& ends) {
  fields.one_of(ends.side, Side::right);
  fields.u32(ends.counts.present.bits);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    bounded(fields, ends.counts.low_counts[slot]);
    bounded(fields, ends.counts.high_counts[slot]);
  }
}

bool has_stuck(const hand::Wearer& wearer) {
  return wearer.watched || wearer.left.left_out.bits != 0 || wearer.right.left_out.bits != 0;
}

void stuck_fields(auto& fields, auto& wearer) {
  fields.counts(wearer.watched);
  for (auto* mask : {&wearer.stuck, &wearer.left.left_out, &wearer.right.left_out})
    fields.bits(mask->bits, sensor_slots);
}

void size_fields(auto& fields, auto& size) {
  fields.number(size.length_m, min_hand_m, max_hand_m);
  fields.number(size.breadth_m, min_hand_m, max_hand_m);
}

void shape_fields(auto& fields, auto& own, auto& other) {
  // The terms that are together, first those of the one hand and then those of the other.
  constexpr std::pair<std::size_t, std::size_t> ranges[] = {
      {0, 26}, {26, 28}, {28, hand::shape_terms}};
  for (const auto& [begin, end] : ranges)
    for (auto* shape : {&own, &other})
      for (std::size_t k = begin; k < end; ++k) {
        const double max = hand::max_of(static_cast<hand::ShapeTerm>(k));
        fields.number(shape->terms[k], -max, max);
      }
}

void layer_fields(auto& fields, auto& layer) {
  constexpr double max_rad = 7.0; // a turn
  fields.bits(layer.joints.bits, hand::angle_count);
  fields.flag(layer.on);
  fields.number(layer.weight, 0.0, 1.0);
  fields.optional(layer.below, [&](auto& below) {
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      fields.number(below[hand::angle_at(at)], -max_rad, max_rad);
  });
}

void head_fields(auto& fields, auto& setup) {
  fields.time(setup.begun);
  fields.time(setup.begun_host);
  fields.text(setup.program);
  fields.text(setup.wearer);
}

/// `own` and `other`: the hands of the wearer for gloves of the first sample's side, and of the
/// other side.
void hand_fields(auto& fields, auto& hand, auto& own, auto& other, std::uint8_t number) {
  constexpr bool reads = std::remove_cvref_t<decltype(fields)>::reads;
  auto& wearer = hand.wearer;
  fields.one_of(hand.side, Side::right);
  size_fields(fields, own.size);
  RecordedSample first{number, hand.first};
  sample_body(fields, first);
  fields.require(first.glove == number);
  if constexpr (reads) hand.first = first.sample;
  fields.flag(hand.gated);
  if (fields.filter_kind(hand.filter, ends_bit, wearer.ends.has_value())) {
    if constexpr (reads) wearer.ends.emplace();
  }
  filter_fields(fields, hand.filter);
  fields.counts(wearer.adapt);
  calibration_fields(fields, own.calibration);
  calibration_fields(fields, other.calibration);
  size_fields(fields, other.size);
  fields.optional(wearer.learned, [&](auto& learned) { learned_fields(fields, learned); });
  fields.optional(hand.layer, [&](auto& layer) { layer_fields(fields, layer); });
  bool differs = !own.size.shape.is_average() || !other.size.shape.is_average();
  fields.flag(differs);
  if (differs) shape_fields(fields, own.size.shape, other.size.shape);
  if (wearer.ends) ends_fields(fields, *wearer.ends);
  if (fields.has_end(has_stuck(wearer))) stuck_fields(fields, wearer);
}

constexpr double farthest_mount_m = 10.0;

void turn_fields(auto& fields, auto& turn) {
  for (auto& part : turn.coeffs())
    fields.number(part, -1.01, 1.01);
}

void mount_fields(auto& fields, auto& mount) {
  turn_fields(fields, mount.stage_from_tracker);
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 4; ++column)
      fields.number(mount.T_station_wrist(row, column), -farthest_mount_m, farthest_mount_m);
  fields.flag(mount.on_hand);
  bounded(fields, mount.late_s);
}

void tracking_fields(auto& fields, auto& options) {
  constexpr std::chrono::nanoseconds max_pause = std::chrono::hours(1);
  mount_fields(fields, options.mount);
  bounded(fields, options.gate.max_distance_m);
  fields.one_of(options.filter.kind, hand::FilterKind::one_euro);
  bounded(fields, options.filter.min_cutoff_hz);
  bounded(fields, options.filter.beta_hz_per_m_s);
  bounded(fields, options.filter.beta_hz_per_rad_s);
  bounded(fields, options.filter.derivative_cutoff_hz);
  bounded(fields, options.movement_scale);
  std::chrono::nanoseconds lost_after = options.lost_after;
  fields.time_span(lost_after);
  fields.require(lost_after >= std::chrono::nanoseconds::zero() && lost_after <= max_pause);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads) options.lost_after = lost_after;
}

void tracker_fields(auto& fields, auto& tracker, auto& options) {
  constexpr double max_rate_hz = 1e6;
  auto& info = tracker.info;
  fields.one_of(tracker.side, Side::right);
  fields.u16(tracker.station);
  fields.line(info.source);
  fields.line(info.model);
  fields.number(info.rate_hz, 0.0, max_rate_hz);
  for (auto& part : info.stage_from_tracker_xyzw)
    fields.number(part, -1.01, 1.01);
  fields.flag(info.is_filtered);
  fact_fields(fields, info.facts);
  tracking_fields(fields, options);
}

} // namespace

void put_tracker(ByteWriter& writer, const RecordedTracker& tracker,
                 const hand::TrackingOptions& options) {
  FieldWriter fields(writer);
  tracker_fields(fields, tracker, options);
}

bool read_tracker(ByteReader& reader, Setup& setup) {
  FieldReader fields(reader);
  RecordedTracker tracker;
  hand::TrackingOptions options;
  tracker_fields(fields, tracker, options);
  if (!fields.fine()) return false;
  const auto hand = std::ranges::find_if(
      setup.hands, [&](const flow::HandInput& input) { return input.side == tracker.side; });
  if (hand == setup.hands.end() || hand->wrist_source) return false;
  hand->wrist_source = flow::WristSource{nullptr, options};
  tracker.info.stations = {tracker.station};
  setup.trackers.push_back(std::move(tracker));
  return true;
}

void put_head(ByteWriter& writer, const Setup& setup) {
  FieldWriter fields(writer);
  head_fields(fields, setup);
}

bool read_head(ByteReader& reader, Setup& setup) {
  FieldReader fields(reader);
  Setup read;
  head_fields(fields, read);
  if (!fields.fine()) return false;
  setup.begun = read.begun;
  setup.begun_host = read.begun_host;
  setup.program = std::move(read.program);
  setup.wearer = std::move(read.wearer);
  return true;
}

void put_hand(ByteWriter& writer, std::uint8_t number, const flow::HandInput& hand) {
  FieldWriter fields(writer);
  hand_fields(fields, hand, hand.wearer.of(hand.first.side),
              hand.wearer.of(opposite(hand.first.side)), number);
}

bool read_hand(ByteReader& reader, std::vector<flow::HandInput>& hands) {
  FieldReader fields(reader);
  flow::HandInput hand;
  hand::WearerHand own, other;
  hand_fields(fields, hand, own, other, static_cast<std::uint8_t>(hands.size()));
  if (!fields.fine()) return false;
  own.left_out = hand.wearer.of(hand.first.side).left_out;
  other.left_out = hand.wearer.of(opposite(hand.first.side)).left_out;
  hand.wearer.of(hand.first.side) = own;
  hand.wearer.of(opposite(hand.first.side)) = other;
  hands.push_back(hand);
  if (flow::check_inputs(hands)) return true;
  hands.pop_back();
  return false;
}

} // namespace nendo::recording
