#include "setup_parts.hpp"

#include <cmath>

#include <nendo/driver/sample_record.hpp>

namespace nendo::recording {
namespace {

constexpr std::size_t most_hands = 2;
constexpr double largest = 1e6; // of anything that a hand is described by
constexpr double least_hand_m = 0.01;
constexpr double most_hand_m = 1.0;

bool is_number(double value) {
  return std::abs(value) <= largest; // false for NaN
}

bool is_hand_length(double length_m) {
  return length_m >= least_hand_m && length_m <= most_hand_m;
}

/// The next numbers, and whether all of them are some.
struct Numbers {
  ByteReader& reader;
  bool fine = true;

  double next() {
    const double value = reader.f64_le();
    fine = fine && is_number(value);
    return value;
  }
};

void put_line(ByteWriter& writer, const hand::SensorCalibration& line) {
  writer.f64_le(line.gain_rad_per_count);
  writer.f64_le(line.offset_counts);
}

void read_line(Numbers& numbers, hand::SensorCalibration& line) {
  line.gain_rad_per_count = numbers.next();
  line.offset_counts = numbers.next();
}

void put_calibration(ByteWriter& writer, const hand::Calibration& calibration) {
  for (const auto& line : calibration.sensors)
    put_line(writer, line);
  for (const double part : calibration.mixed_in)
    writer.f64_le(part);
  writer.f64_le(calibration.middle_bias);
}

bool read_calibration(ByteReader& reader, hand::Calibration& calibration) {
  Numbers numbers{reader};
  for (auto& line : calibration.sensors)
    read_line(numbers, line);
  for (double& part : calibration.mixed_in)
    part = numbers.next();
  calibration.middle_bias = numbers.next();
  return numbers.fine;
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

/// Whether they can have been learned is for RangeAdaptation to judge.
bool read_learned(ByteReader& reader, hand::LearnedRanges& learned) {
  const unsigned side = reader.u8();
  learned.side = side == 0 ? Side::left : Side::right;
  Numbers numbers{reader};
  for (auto& sensor : learned.sensors) {
    sensor.low_counts = numbers.next();
    sensor.high_counts = numbers.next();
    sensor.bottoms = reader.u32_le();
    sensor.tops = reader.u32_le();
    read_line(numbers, sensor.line);
  }
  return side <= 1 && numbers.fine;
}

bool read_filter(ByteReader& reader, hand::FilterOptions& filter) {
  const unsigned kind = reader.u8();
  filter.kind = static_cast<hand::FilterKind>(kind);
  Numbers numbers{reader};
  filter.min_cutoff_hz = numbers.next();
  filter.beta_hz_per_rad_s = numbers.next();
  filter.derivative_cutoff_hz = numbers.next();
  return kind <= static_cast<unsigned>(hand::FilterKind::one_euro) && numbers.fine;
}

void put_size(ByteWriter& writer, const hand::HandSize& size) {
  writer.f64_le(size.length_m);
  writer.f64_le(size.breadth_m);
}

bool read_size(ByteReader& reader, hand::HandSize& size) {
  size.length_m = reader.f64_le();
  size.breadth_m = reader.f64_le();
  return is_hand_length(size.length_m) && is_hand_length(size.breadth_m);
}

} // namespace

void put_head(ByteWriter& writer, const Setup& setup) {
  writer.i64_le(setup.begun.time_since_epoch().count());
  driver::put_time(writer, setup.begun_host);
  writer.text(setup.program);
  writer.text(setup.wearer);
}

bool read_head(ByteReader& reader, Setup& setup) {
  const std::chrono::nanoseconds begun(reader.i64_le());
  const HostTime begun_host = driver::read_time(reader);
  const std::string_view program = reader.text();
  const std::string_view wearer = reader.text();
  if (reader.overrun() || !driver::is_usable_time(begun) ||
      !driver::is_usable_time(begun_host.time_since_epoch()))
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
  driver::put_sample_body(writer, {number, hand.first});
  writer.u8(static_cast<std::uint8_t>(hand.gated));
  writer.u8(static_cast<std::uint8_t>(hand.filter.kind));
  writer.f64_le(hand.filter.min_cutoff_hz);
  writer.f64_le(hand.filter.beta_hz_per_rad_s);
  writer.f64_le(hand.filter.derivative_cutoff_hz);
  writer.u8(static_cast<std::uint8_t>(adapt.has_value()));
  writer.u16_le(adapt ? adapt->most : 0);
  writer.u8(static_cast<std::uint8_t>(adapt && adapt->whole_range));
  put_calibration(writer, own.calibration);
  put_calibration(writer, other.calibration);
  put_size(writer, other.size);
  writer.u8(static_cast<std::uint8_t>(hand.wearer.learned.has_value()));
  if (hand.wearer.learned) put_learned(writer, *hand.wearer.learned);
}

bool read_hand(ByteReader& reader, std::vector<flow::HandInput>& hands) {
  flow::HandInput hand;
  hand::WearerHand own, other;
  const unsigned side = reader.u8();
  hand.side = side == 0 ? Side::left : Side::right;
  const bool sized = read_size(reader, own.size);
  const auto first = driver::read_sample_body(reader);
  if (!first || first->glove != hands.size() || hands.size() >= most_hands) return false;
  if (!hands.empty() && hands.front().side == hand.side) return false;
  hand.first = first->sample;
  hand.gated = reader.u8() != 0;
  const bool filters = read_filter(reader, hand.filter);
  const bool adapts = reader.u8() != 0;
  const CountScale counts{reader.u16_le(), reader.u8() != 0};
  if (adapts) hand.wearer.adapt = counts;
  const bool calibrated = read_calibration(reader, own.calibration) &&
                          read_calibration(reader, other.calibration) &&
                          read_size(reader, other.size);
  bool has_learned = true;
  if (reader.remaining() > 0 && reader.u8() != 0) // format 1.0 ends before it
    has_learned = read_learned(reader, hand.wearer.learned.emplace());
  if (reader.overrun() || side > 1 || !sized || !filters || !calibrated || !has_learned)
    return false;
  hand.wearer.of(hand.first.side) = own;
  hand.wearer.of(opposite(hand.first.side)) = other;
  hands.push_back(hand);
  return true;
}

} // namespace nendo::recording
