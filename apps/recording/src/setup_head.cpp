#include "setup_parts.hpp"

#include <utility>

#include <nendo/recording/sample_record.hpp>

namespace nendo::recording {
namespace {

constexpr double largest = 1e6; // of all numbers that describe a hand
constexpr double min_hand_m = 0.01;
constexpr double max_hand_m = 1.0;

double bounded_number(CheckedReader& checked) {
  return checked.number(-largest, largest);
}

void put_line(ByteWriter& writer, const hand::SensorCalibration& line) {
  writer.f64_le(line.gain_rad_per_count);
  writer.f64_le(line.offset_counts);
}

void read_line(CheckedReader& checked, hand::SensorCalibration& line) {
  line.gain_rad_per_count = bounded_number(checked);
  line.offset_counts = bounded_number(checked);
}

void put_calibration(ByteWriter& writer, const hand::Calibration& calibration) {
  for (const auto& line : calibration.sensors)
    put_line(writer, line);
  for (const double part : calibration.coupling_gains)
    writer.f64_le(part);
  writer.f64_le(calibration.middle_bias);
}

void read_calibration(CheckedReader& checked, hand::Calibration& calibration) {
  for (auto& line : calibration.sensors)
    read_line(checked, line);
  for (double& part : calibration.coupling_gains)
    part = bounded_number(checked);
  calibration.middle_bias = bounded_number(checked);
}

void put_learned(ByteWriter& writer, const hand::LearnedRanges& learned) {
  writer.u8(static_cast<std::uint8_t>(learned.side));
  for (const auto& sensor : learned.sensors) {
    writer.f64_le(sensor.low_counts);
    writer.f64_le(sensor.high_counts);
    writer.u32_le(sensor.bottoms);
    writer.u32_le(sensor.tops);
    put_line(writer, sensor.line);
  }
}

/// RangeAdaptation judges whether such ranges can have been learned.
void read_learned(ByteReader& reader, CheckedReader& checked, hand::LearnedRanges& learned) {
  learned.side = checked.one_of(Side::right);
  for (auto& sensor : learned.sensors) {
    sensor.low_counts = bounded_number(checked);
    sensor.high_counts = bounded_number(checked);
    sensor.bottoms = reader.u32_le();
    sensor.tops = reader.u32_le();
    read_line(checked, sensor.line);
  }
}

/// Added to the kind of a hand's filter if its wearer's ends follow.
constexpr unsigned ends_bit = 64;

/// Returns whether the wearer's ends follow.
bool read_filter(CheckedReader& checked, hand::FilterOptions& filter) {
  const bool ends_follow = checked.filter_kind(filter, ends_bit) != 0;
  flow::for_each_filter_number(
      [&](const flow::NumberSetting& number) { number.of(filter) = bounded_number(checked); });
  return ends_follow;
}

void put_ends(ByteWriter& writer, const hand::CalibratedRange& ends) {
  writer.u8(static_cast<std::uint8_t>(ends.side));
  writer.u32_le(ends.counts.present.bits);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    writer.f64_le(ends.counts.low_counts[slot]);
    writer.f64_le(ends.counts.high_counts[slot]);
  }
}

/// SlipAdaptation judges whether sensors can have such ends.
void read_ends(ByteReader& reader, CheckedReader& checked, hand::CalibratedRange& ends) {
  ends.side = checked.one_of(Side::right);
  ends.counts.present.bits = reader.u32_le();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    ends.counts.low_counts[slot] = bounded_number(checked);
    ends.counts.high_counts[slot] = bounded_number(checked);
  }
}

bool has_stuck(const hand::Wearer& wearer) {
  return wearer.watched || wearer.left.left_out.bits != 0 || wearer.right.left_out.bits != 0;
}

void put_stuck(ByteWriter& writer, const hand::Wearer& wearer) {
  writer.u8(static_cast<std::uint8_t>(wearer.watched.has_value()));
  writer.u16_le(wearer.watched ? wearer.watched->most : 0);
  writer.u8(static_cast<std::uint8_t>(wearer.watched && wearer.watched->whole_range));
  writer.u32_le(wearer.stuck.bits);
  writer.u32_le(wearer.left.left_out.bits);
  writer.u32_le(wearer.right.left_out.bits);
}

void read_stuck(ByteReader& reader, CheckedReader& checked, hand::Wearer& wearer) {
  constexpr std::uint32_t all_slots = (1U << sensor_slots) - 1U;
  const bool watches = reader.u8() != 0;
  const CountScale counts{reader.u16_le(), reader.u8() != 0};
  if (watches) wearer.watched = counts;
  for (SensorMask* mask : {&wearer.stuck, &wearer.left.left_out, &wearer.right.left_out}) {
    mask->bits = reader.u32_le();
    checked.require((mask->bits & ~all_slots) == 0);
  }
}

void put_size(ByteWriter& writer, const hand::HandSize& size) {
  writer.f64_le(size.length_m);
  writer.f64_le(size.breadth_m);
}

void read_size(CheckedReader& checked, hand::HandSize& size) {
  size.length_m = checked.number(min_hand_m, max_hand_m);
  size.breadth_m = checked.number(min_hand_m, max_hand_m);
}

/// The terms that stand together, first those of the one hand and then those of the other.
constexpr std::pair<std::size_t, std::size_t> shape_ranges[] = {
    {0, 26}, {26, 28}, {28, hand::shape_terms}};

void put_shapes(ByteWriter& writer, const hand::WearerShape& own, const hand::WearerShape& other) {
  for (const auto& [begin, end] : shape_ranges)
    for (const hand::WearerShape* shape : {&own, &other})
      for (std::size_t k = begin; k < end; ++k)
        writer.f64_le(shape->terms[k]);
}

void read_shape(CheckedReader& checked, std::size_t begin, std::size_t end,
                hand::WearerShape& shape) {
  for (std::size_t k = begin; k < end; ++k) {
    const double most = hand::max_of(static_cast<hand::ShapeTerm>(k));
    shape.terms[k] = checked.number(-most, most);
  }
}

void put_layer(ByteWriter& writer, const flow::Layer& layer) {
  writer.u32_le(layer.joints.bits);
  writer.u8(static_cast<std::uint8_t>(layer.on));
  writer.f64_le(layer.weight);
  writer.u8(static_cast<std::uint8_t>(layer.below.has_value()));
  if (!layer.below) return;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    writer.f64_le((*layer.below)[hand::angle_at(at)]);
}

void read_layer(ByteReader& reader, CheckedReader& checked, flow::Layer& layer) {
  layer.joints.bits = reader.u32_le();
  checked.require((layer.joints.bits & ~flow::AngleSet::all().bits) == 0);
  layer.on = reader.u8() != 0;
  layer.weight = checked.number(0.0, 1.0);
  if (reader.u8() == 0) return;
  hand::JointAngles& below = layer.below.emplace();
  constexpr double max_rad = 7.0; // a turn
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    below[hand::angle_at(at)] = checked.number(-max_rad, max_rad);
}

} // namespace

void put_head(ByteWriter& writer, const Setup& setup) {
  writer.i64_le(setup.begun.time_since_epoch().count());
  put_time(writer, setup.begun_host);
  writer.text(setup.program);
  writer.text(setup.wearer);
}

bool read_head(ByteReader& reader, Setup& setup) {
  const std::chrono::nanoseconds begun(reader.i64_le());
  const HostTime begun_host = read_time(reader);
  const std::string_view program = reader.text();
  const std::string_view wearer = reader.text();
  if (reader.overrun() || !is_usable_time(begun) || !is_usable_time(begun_host.time_since_epoch()))
    return false;
  setup.begun = std::chrono::sys_time<std::chrono::nanoseconds>(begun);
  setup.begun_host = begun_host;
  setup.program = program;
  setup.wearer = wearer;
  return true;
}

void put_hand(ByteWriter& writer, std::uint8_t number, const flow::HandInput& hand) {
  const hand::WearerHand& own = hand.wearer.of(hand.first.side);
  const hand::WearerHand& other = hand.wearer.of(opposite(hand.first.side));
  const auto& adapt = hand.wearer.adapt;
  writer.u8(static_cast<std::uint8_t>(hand.side));
  put_size(writer, own.size);
  put_sample_body(writer, {number, hand.first});
  writer.u8(static_cast<std::uint8_t>(hand.gated));
  put_filter_kind(writer, hand.filter, hand.wearer.ends ? ends_bit : 0);
  put_filter_numbers(writer, hand.filter);
  writer.u8(static_cast<std::uint8_t>(adapt.has_value()));
  writer.u16_le(adapt ? adapt->most : 0);
  writer.u8(static_cast<std::uint8_t>(adapt && adapt->whole_range));
  put_calibration(writer, own.calibration);
  put_calibration(writer, other.calibration);
  put_size(writer, other.size);
  writer.u8(static_cast<std::uint8_t>(hand.wearer.learned.has_value()));
  if (hand.wearer.learned) put_learned(writer, *hand.wearer.learned);
  writer.u8(static_cast<std::uint8_t>(hand.layer.has_value()));
  if (hand.layer) put_layer(writer, *hand.layer);
  const bool average = own.size.shape.is_average() && other.size.shape.is_average();
  writer.u8(static_cast<std::uint8_t>(!average));
  if (!average) put_shapes(writer, own.size.shape, other.size.shape);
  if (hand.wearer.ends) put_ends(writer, *hand.wearer.ends);
  if (has_stuck(hand.wearer)) put_stuck(writer, hand.wearer);
}

bool read_hand(ByteReader& reader, std::vector<flow::HandInput>& hands) {
  CheckedReader checked(reader);
  flow::HandInput hand;
  hand::WearerHand own, other;
  hand.side = checked.one_of(Side::right);
  read_size(checked, own.size);
  const auto first = read_sample_body(reader);
  if (!first || first->glove != hands.size()) return false;
  hand.first = first->sample;
  hand.gated = reader.u8() != 0;
  const bool ends_follow = read_filter(checked, hand.filter);
  const bool adapts = reader.u8() != 0;
  const CountScale counts{reader.u16_le(), reader.u8() != 0};
  if (adapts) hand.wearer.adapt = counts;
  read_calibration(checked, own.calibration);
  read_calibration(checked, other.calibration);
  read_size(checked, other.size);
  if (reader.u8() != 0) read_learned(reader, checked, hand.wearer.learned.emplace());
  if (reader.u8() != 0) read_layer(reader, checked, hand.layer.emplace());
  if (reader.u8() != 0) {
    for (const auto& [begin, end] : shape_ranges) {
      read_shape(checked, begin, end, own.size.shape);
      read_shape(checked, begin, end, other.size.shape);
    }
  }
  if (ends_follow) read_ends(reader, checked, hand.wearer.ends.emplace());
  if (reader.remaining() > 0) read_stuck(reader, checked, hand.wearer);
  if (!checked.fine()) return false;
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
