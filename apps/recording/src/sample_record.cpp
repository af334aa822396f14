#include <nendo/recording/sample_record.hpp>

#include <algorithm>
#include <array>
#include <type_traits>

#include "setup_parts.hpp"

namespace nendo::recording {
namespace {

constexpr double max_rate_hz = 1e6;

constexpr unsigned device_time_flag = 1U << 0U;
constexpr unsigned too_fast_flag = 1U << 1U;
constexpr unsigned switch_shift = 2; // two bits
constexpr unsigned right_flag = 1U << 4U;

std::uint8_t flags_of(const GloveSample& sample) noexcept {
  unsigned flags = static_cast<unsigned>(sample.wrist_switch) << switch_shift;
  if (sample.has_device_time) flags |= device_time_flag;
  if (sample.sampled_too_fast) flags |= too_fast_flag;
  if (sample.side == Side::right) flags |= right_flag;
  return static_cast<std::uint8_t>(flags);
}

bool set_flags(GloveSample& sample, unsigned flags) noexcept {
  sample.has_device_time = (flags & device_time_flag) != 0;
  sample.sampled_too_fast = (flags & too_fast_flag) != 0;
  sample.side = (flags & right_flag) != 0 ? Side::right : Side::left;
  const unsigned position = flags >> switch_shift & 3U;
  sample.wrist_switch = static_cast<WristSwitch>(position);
  return position <= static_cast<unsigned>(WristSwitch::on) && flags >> 5U == 0;
}

void sample_fields(auto& fields, auto& recorded) {
  auto& sample = recorded.sample;
  fields.u8(recorded.glove);
  fields.time(sample.arrival);
  fields.time(sample.measured);
  fields.time_span(sample.device_time);
  fields.u64(sample.sequence);
  fields.bits(sample.present.bits, sensor_slots);
  std::uint8_t flags = flags_of(sample);
  fields.u8(flags);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads)
    fields.require(set_flags(sample, flags));
  for (auto& count : sample.raw)
    fields.u16(count.value);
}

void glove_fields(auto& fields, auto& glove) {
  constexpr bool reads = std::remove_cvref_t<decltype(fields)>::reads;
  auto& info = glove.info;
  fields.u8(glove.number);
  fields.one_of(info.side, Side::right);
  fields.line(info.source);
  fields.line(info.model);
  fields.bits(info.sensors.bits, sensor_slots);
  fields.number(info.rate_hz, 0.0, max_rate_hz);
  fields.u16(info.counts.max_count);
  fields.flag(info.counts.self_calibrated);
  auto& has = info.abilities;
  const std::array flags{&has.wrist_switch, &has.light, &has.vibration, &has.resistance};
  unsigned bits = 0;
  for (std::size_t at = 0; at < flags.size(); ++at)
    bits |= unsigned{*flags[at]} << at;
  auto byte = static_cast<std::uint8_t>(bits);
  fields.u8(byte);
  if constexpr (reads)
    for (std::size_t at = 0; at < flags.size(); ++at)
      *flags[at] = (unsigned{byte} >> at & 1U) != 0;
  fact_fields(fields, info.facts);
}

void pose_fields(auto& fields, auto& recorded) {
  auto& pose = recorded.pose;
  fields.one_of(recorded.side, Side::right);
  fields.time(pose.arrival);
  fields.time(pose.measured);
  fields.time_span(pose.device_time);
  fields.u64(pose.sequence);
  fields.u16(pose.station);
  for (auto& coordinate : pose.position_m)
    fields.number(coordinate);
  for (auto& part : pose.turn_xyzw)
    fields.number(part);
  auto error = static_cast<std::uint8_t>(pose.error);
  fields.u8(error);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads) pose.error = static_cast<char>(error);
  fields.flag(pose.has_device_time);
}

} // namespace

std::optional<LogEntry> LogEntries::next() noexcept {
  if (reader_.remaining() == 0) return std::nullopt;
  LogEntry record;
  record.kind = reader_.u8();
  record.body = reader_.take(reader_.u8());
  if (reader_.overrun()) return std::nullopt;
  return record;
}

void sample_body(FieldWriter& fields, const RecordedSample& recorded) {
  sample_fields(fields, recorded);
}

void sample_body(FieldReader& fields, RecordedSample& recorded) {
  sample_fields(fields, recorded);
}

void pose_body(FieldWriter& fields, const RecordedPose& recorded) {
  pose_fields(fields, recorded);
}

void pose_body(FieldReader& fields, RecordedPose& recorded) {
  pose_fields(fields, recorded);
}

std::optional<RecordedPose> pose_of(const LogEntry& record) noexcept {
  if (!record.is(EntryKind::pose)) return std::nullopt;
  return read_value<RecordedPose>(record.body, pose_fields<FieldReader, RecordedPose>);
}

std::optional<RecordedSample> sample_of(const LogEntry& record) noexcept {
  if (!record.is(EntryKind::sample)) return std::nullopt;
  return read_value<RecordedSample>(record.body, sample_fields<FieldReader, RecordedSample>);
}

void put_glove(ByteWriter& writer, const RecordedGlove& glove) {
  FieldWriter fields(writer);
  glove_fields(fields, glove);
}

std::optional<RecordedGlove> glove_of(std::span<const std::byte> payload) {
  return read_value<RecordedGlove>(payload, glove_fields<FieldReader, RecordedGlove>);
}

} // namespace nendo::recording
