#include <nendo/recording/sample_record.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/text.hpp>

namespace nendo::recording {
namespace {

constexpr std::size_t sample_bytes = 86;
constexpr std::chrono::nanoseconds max_time{std::int64_t{1} << 62U};
constexpr std::size_t max_facts = 256;
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

unsigned bit(bool set, unsigned at) noexcept {
  return static_cast<unsigned>(set) << at;
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

void put_entry_head(ByteWriter& writer, EntryKind kind, std::size_t body_bytes) {
  writer.u8(static_cast<std::uint8_t>(kind));
  writer.u8(static_cast<std::uint8_t>(body_bytes));
}

bool is_usable_time(std::chrono::nanoseconds since_epoch) noexcept {
  return since_epoch > -max_time / 2 && since_epoch < max_time / 2;
}

void put_time(ByteWriter& writer, HostTime time) {
  writer.i64_le(std::chrono::nanoseconds(time.time_since_epoch()).count());
}

HostTime read_time(ByteReader& reader) noexcept {
  return HostTime(std::chrono::nanoseconds(reader.i64_le()));
}

void put_sample_body(ByteWriter& writer, const RecordedSample& recorded) {
  const GloveSample& sample = recorded.sample;
  writer.u8(recorded.glove);
  put_time(writer, sample.arrival);
  put_time(writer, sample.measured);
  writer.i64_le(sample.device_time.count());
  writer.u64_le(sample.sequence);
  writer.u32_le(sample.present.bits);
  writer.u8(flags_of(sample));
  for (const RawCount count : sample.raw)
    writer.u16_le(count.value);
}

std::optional<RecordedSample> read_sample_body(ByteReader& reader) noexcept {
  RecordedSample recorded;
  GloveSample& sample = recorded.sample;
  recorded.glove = reader.u8();
  sample.arrival = read_time(reader);
  sample.measured = read_time(reader);
  sample.device_time = std::chrono::nanoseconds(reader.i64_le());
  sample.sequence = reader.u64_le();
  sample.present.bits = reader.u32_le();
  const bool fine = set_flags(sample, reader.u8());
  for (RawCount& count : sample.raw)
    count.value = reader.u16_le();
  if (!fine || reader.overrun() || sample.present.bits >> sensor_slots != 0 ||
      !is_usable_time(sample.arrival.time_since_epoch()) ||
      !is_usable_time(sample.measured.time_since_epoch()) || !is_usable_time(sample.device_time))
    return std::nullopt;
  return recorded;
}

void put_sample(ByteWriter& writer, const RecordedSample& recorded) {
  put_entry_head(writer, EntryKind::sample, sample_bytes);
  put_sample_body(writer, recorded);
}

std::optional<RecordedSample> sample_of(const LogEntry& record) noexcept {
  if (!record.is(EntryKind::sample) || record.body.size() < sample_bytes) return std::nullopt;
  ByteReader reader(record.body);
  return read_sample_body(reader);
}

void put_glove(ByteWriter& writer, const RecordedGlove& glove) {
  const driver::GloveInfo& info = glove.info;
  writer.u8(glove.number);
  writer.u8(static_cast<std::uint8_t>(info.side));
  writer.text(info.source);
  writer.text(info.model);
  writer.u32_le(info.sensors.bits);
  writer.f64_le(info.rate_hz);
  writer.u16_le(info.counts.most);
  writer.u8(static_cast<std::uint8_t>(info.counts.whole_range));
  writer.u8(static_cast<std::uint8_t>(
      bit(info.abilities.wrist_switch, 0) | bit(info.abilities.light, 1) |
      bit(info.abilities.vibration, 2) | bit(info.abilities.resistance, 3)));
  const std::size_t facts = std::min(info.facts.size(), max_facts);
  writer.u16_le(static_cast<std::uint16_t>(facts));
  for (std::size_t at = 0; at < facts; ++at) {
    writer.text(info.facts[at].name);
    writer.text(info.facts[at].value);
  }
}

std::optional<RecordedGlove> glove_of(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  RecordedGlove glove;
  driver::GloveInfo& info = glove.info;
  glove.number = reader.u8();
  const unsigned side = reader.u8();
  info.side = side == 0 ? Side::left : Side::right;
  info.source = printable(reader.text());
  info.model = printable(reader.text());
  info.sensors.bits = reader.u32_le();
  info.rate_hz = reader.f64_le();
  info.counts.most = reader.u16_le();
  info.counts.whole_range = reader.u8() != 0;
  const unsigned abilities = reader.u8();
  info.abilities = {(abilities & 1U) != 0, (abilities & 2U) != 0, (abilities & 4U) != 0,
                    (abilities & 8U) != 0};
  const std::size_t facts = reader.u16_le();
  if (side > 1 || facts > max_facts || info.sensors.bits >> sensor_slots != 0 ||
      !(info.rate_hz >= 0.0 && info.rate_hz <= max_rate_hz))
    return std::nullopt;
  for (std::size_t at = 0; at < facts && !reader.overrun(); ++at) {
    std::string name = printable(reader.text());
    info.facts.push_back({std::move(name), printable(reader.text())});
  }
  if (reader.overrun()) return std::nullopt;
  return glove;
}

} // namespace nendo::recording
