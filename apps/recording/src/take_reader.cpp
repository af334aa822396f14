#include <nendo/recording/take_reader.hpp>

#include <algorithm>
#include <utility>

#include "setup_parts.hpp"

namespace nendo::recording {
namespace {

constexpr std::size_t tick_bytes = 24;
constexpr std::size_t request_bytes = 1;
constexpr std::size_t gap_bytes = 8;
constexpr std::size_t wrist_bytes = 57;
constexpr std::size_t model_bytes = 21;
constexpr std::size_t clutch_bytes = 3;
constexpr std::size_t role_bytes = 4;
constexpr std::size_t layer_bytes = 2;
constexpr std::size_t puppet_bytes = 4;

struct EntryWriter {
  ByteWriter& writer;

  void operator()(const RecordedSample& sample) const { put_sample(writer, sample); }
  void operator()(flow::Request request) const {
    put_entry_head(writer, EntryKind::request, request_bytes);
    writer.u8(static_cast<std::uint8_t>(request));
  }
  void operator()(const flow::LoggedTick& tick) const {
    put_entry_head(writer, EntryKind::tick, tick_bytes);
    writer.u64_le(tick.number);
    put_time(writer, tick.scheduled);
    put_time(writer, tick.woke);
  }
  void operator()(const flow::WristMove& move) const {
    put_entry_head(writer, EntryKind::wrist, wrist_bytes);
    writer.u8(static_cast<std::uint8_t>(move.side));
    for (const double number : move.position_m)
      writer.f64_le(number);
    for (const double number : move.turn_xyzw)
      writer.f64_le(number);
  }
  void operator()(const flow::LoopSettings& settings) const {
    put_entry_head(writer, EntryKind::settings, settings_bytes + brushes_bytes + hold_bytes);
    put_settings(writer, settings);
    put_brushes(writer, settings);
    put_hold(writer, settings);
  }
  void operator()(const flow::HoldStill&) const {
    put_entry_head(writer, EntryKind::hold_still, 0);
  }
  void operator()(const flow::ChangeModel& change) const {
    put_entry_head(writer, EntryKind::model, model_bytes);
    writer.u32_le(change.number);
    writer.u8(static_cast<std::uint8_t>(change.source));
    writer.u32_le(change.max_vertices);
    writer.f64_le(change.seam_width);
    writer.u32_le(change.part);
  }
  void operator()(const flow::Mark&) const { put_entry_head(writer, EntryKind::mark, 0); }
  void operator()(const flow::SetClutch& clutch) const {
    put_entry_head(writer, EntryKind::clutch, clutch_bytes);
    writer.u8(static_cast<std::uint8_t>(clutch.side));
    writer.u8(clutch.finger);
    writer.u8(static_cast<std::uint8_t>(clutch.holds));
  }
  void operator()(const flow::SetRole& role) const {
    put_entry_head(writer, EntryKind::role, role_bytes);
    writer.u16_le(role.function);
    put_signal(writer, role.input);
  }
  void operator()(const flow::SetSymmetry& symmetry) const {
    put_entry_head(writer, EntryKind::symmetry, 1);
    writer.u8(static_cast<std::uint8_t>(symmetry.on));
  }
  void operator()(const flow::SetLayer& layer) const {
    put_entry_head(writer, EntryKind::layer, layer_bytes);
    writer.u8(layer.input);
    writer.u8(static_cast<std::uint8_t>(layer.on));
  }
  void operator()(const flow::DrawWire& wire) const {
    put_entry_head(writer, EntryKind::wire, 1);
    writer.u8(static_cast<std::uint8_t>(wire.on ? 1U + static_cast<unsigned>(wire.blade) : 0U));
  }
  void operator()(const PuppetChange& change) const {
    put_entry_head(writer, EntryKind::puppet, puppet_bytes);
    writer.u32_le(change.number);
  }
  void operator()(const Gap& gap) const {
    put_entry_head(writer, EntryKind::gap, gap_bytes);
    writer.u64_le(gap.entries);
  }
};

std::optional<Entry> request_of(std::uint8_t value) {
  const auto* const found =
      std::find_if(flow::requests.begin(), flow::requests.end(), [value](flow::Request known) {
        return static_cast<std::uint8_t>(known) == value;
      });
  if (found == flow::requests.end()) return std::nullopt;
  return *found;
}

std::optional<Entry> tick_of(ByteReader& reader) {
  flow::LoggedTick tick;
  tick.number = reader.u64_le();
  tick.scheduled = read_time(reader);
  tick.woke = read_time(reader);
  if (reader.overrun() || !is_usable_time(tick.scheduled.time_since_epoch()) ||
      !is_usable_time(tick.woke.time_since_epoch()))
    return std::nullopt;
  return tick;
}

std::optional<Entry> wrist_of(ByteReader& reader) {
  flow::WristMove move;
  const std::uint8_t side = reader.u8();
  for (double& number : move.position_m)
    number = reader.f64_le();
  for (double& number : move.turn_xyzw)
    number = reader.f64_le();
  if (reader.overrun() || side > static_cast<std::uint8_t>(Side::right) || !move.is_usable())
    return std::nullopt;
  move.side = static_cast<Side>(side);
  return move;
}

std::optional<Entry> model_of(ByteReader& reader) {
  flow::ChangeModel change;
  change.number = reader.u32_le();
  const std::uint8_t source = reader.u8();
  if (reader.overrun() || source > static_cast<std::uint8_t>(flow::ModelSource::topology))
    return std::nullopt;
  change.source = static_cast<flow::ModelSource>(source);
  change.max_vertices = reader.u32_le();
  change.seam_width = reader.f64_le();
  change.part = reader.u32_le();
  if (reader.overrun() || !(change.seam_width >= 0.0) || !std::isfinite(change.seam_width))
    return std::nullopt;
  return change;
}

std::optional<Entry> wire_of(ByteReader& reader) {
  const std::uint8_t blade = reader.u8(); // from 1 on
  if (reader.overrun() || blade > 1U + static_cast<unsigned>(flow::Blade::knife))
    return std::nullopt;
  if (blade == 0) return flow::DrawWire{};
  return flow::DrawWire{true, static_cast<flow::Blade>(blade - 1U)};
}

std::optional<Entry> clutch_of(ByteReader& reader) {
  flow::SetClutch clutch;
  const std::uint8_t side = reader.u8();
  clutch.finger = reader.u8();
  clutch.holds = reader.u8() != 0;
  if (reader.overrun() || side > static_cast<std::uint8_t>(Side::right)) return std::nullopt;
  clutch.side = static_cast<Side>(side);
  return clutch;
}

std::optional<Entry> role_of(ByteReader& reader) {
  flow::SetRole role;
  role.function = reader.u16_le();
  const auto input = read_signal(reader);
  if (!input || reader.overrun()) return std::nullopt;
  role.input = *input;
  return role;
}

std::optional<Ending> ending_of(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  Ending ending;
  ending.host = read_time(reader);
  ending.samples = reader.u64_le();
  ending.requests = reader.u64_le();
  ending.ticks = reader.u64_le();
  ending.lost = reader.u64_le();
  const bool has_shape = reader.u8() != 0;
  ShapeSum shape;
  shape.vertices = reader.u64_le();
  shape.crc = reader.u32_le();
  if (has_shape) ending.shape = shape;
  if (reader.overrun() || !is_usable_time(ending.host.time_since_epoch())) return std::nullopt;
  return ending;
}

std::optional<std::vector<driver::RecordCounts>> sent_of(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  std::vector<driver::RecordCounts> gloves(reader.u8());
  for (driver::RecordCounts& counts : gloves) {
    counts.delivered = reader.u64_le();
    counts.missed = reader.u64_le();
    counts.refused = reader.u64_le();
    counts.bad = reader.u64_le();
  }
  for (driver::RecordCounts& counts : gloves) {
    counts.tells_missed = reader.u8() != 0;
    counts.clamped = reader.u64_le();
  }
  if (reader.overrun()) return std::nullopt;
  return gloves;
}

} // namespace

void put_entry(ByteWriter& writer, const Entry& entry) {
  std::visit(EntryWriter{writer}, entry);
}

void put_ending(ByteWriter& writer, const Ending& ending) {
  put_time(writer, ending.host);
  for (const std::uint64_t count : {ending.samples, ending.requests, ending.ticks, ending.lost})
    writer.u64_le(count);
  const ShapeSum shape = ending.shape.value_or(ShapeSum{});
  writer.u8(static_cast<std::uint8_t>(ending.shape.has_value()));
  writer.u64_le(shape.vertices);
  writer.u32_le(shape.crc);
}

void put_sent(ByteWriter& writer, std::span<const driver::RecordCounts> gloves) {
  writer.u8(static_cast<std::uint8_t>(gloves.size()));
  for (const driver::RecordCounts& counts : gloves)
    for (const std::uint64_t count : {counts.delivered, counts.missed, counts.refused, counts.bad})
      writer.u64_le(count);
  for (const driver::RecordCounts& counts : gloves) {
    writer.u8(counts.tells_missed ? 1 : 0);
    writer.u64_le(counts.clamped);
  }
}

TakeReader::TakeReader(ChunkReader chunks) : chunks_(std::move(chunks)) {
  next_chunk(); // the setup stands before the first input log
}

Result<TakeReader> TakeReader::begin(ChunkReader chunks, const std::string& name) {
  TakeReader reader(std::move(chunks));
  if (reader.chunks_.good_end() > file_header().size()) return reader;
  return Error{Errc::bad_input, name + ": is cut off or damaged before anything was recorded"};
}

Result<TakeReader> TakeReader::open(const std::filesystem::path& path) {
  auto chunks = ChunkReader::open(path);
  if (!chunks) return chunks.error();
  return begin(*std::move(chunks), path.string());
}

Result<TakeReader> TakeReader::of(std::span<const std::byte> bytes, std::string_view name) {
  auto chunks = ChunkReader::of(bytes, name);
  if (!chunks) return chunks.error();
  return begin(*std::move(chunks), std::string(name));
}

/// Continues to the next chunk of an input log. Returns false if there is none.
bool TakeReader::next_chunk() {
  for (;;) {
    const auto chunk = chunks_.next();
    gap_due_ = gap_due_ || chunks_.damage_count() > damages_seen_;
    damages_seen_ = chunks_.damage_count();
    if (!chunk) return false;
    if (chunk->type == log_chunk) {
      setup_done_ = true;
      records_ = LogEntries(chunk->payload);
      return true;
    }
    if (!take_chunk(*chunk)) ++unknown_entries_;
  }
}

/// Takes a chunk that is no input log's. Returns false if nendo does not write such a one.
bool TakeReader::take_chunk(const Chunk& chunk) {
  if (chunk.type == ending_chunk) {
    ending_ = ending_of(chunk.payload);
    return ending_.has_value();
  }
  if (chunk.type == shape_chunk) {
    shape_ = read_shape(chunk.payload);
    if (shape_) ++shapes_;
    return shape_.has_value();
  }
  if (chunk.type == sent_chunk) {
    auto sent = sent_of(chunk.payload);
    const bool fine = sent && sent->size() == setup_.gloves.size();
    if (fine) sent_ = *std::move(sent);
    return fine;
  }
  if (chunk.type == puppet_version_chunk) {
    auto read = read_puppet_version(chunk.payload);
    if (!read) return false;
    puppets_[read->number] = std::make_shared<const RecordedPuppet>(std::move(read->puppet));
    return true;
  }
  if (setup_done_ && is_setup_chunk(chunk.type)) return false; // it does not change any more
  return read_setup_chunk(chunk.type, chunk.payload, setup_);
}

/// Returns nothing if the kind of the entry is unknown. Returns nothing, and makes a gap due, if
/// the entry cannot be used.
std::optional<Entry> TakeReader::entry_of(const LogEntry& record) {
  ByteReader reader(record.body);
  std::optional<Entry> entry;
  if (record.is(EntryKind::sample)) {
    const auto sample = sample_of(record);
    if (sample && sample->glove < setup_.gloves.size()) entry = *sample;
  } else if (record.is(EntryKind::request)) {
    const std::uint8_t request = reader.u8();
    if (!reader.overrun()) entry = request_of(request);
  } else if (record.is(EntryKind::tick)) {
    entry = tick_of(reader);
  } else if (record.is(EntryKind::wrist)) {
    entry = wrist_of(reader);
  } else if (record.is(EntryKind::settings)) {
    auto settings = read_settings(reader);
    if (settings && read_brushes(reader, *settings) && read_hold(reader, *settings))
      entry = *settings;
  } else if (record.is(EntryKind::hold_still)) {
    entry = flow::HoldStill{};
  } else if (record.is(EntryKind::model)) {
    entry = model_of(reader);
  } else if (record.is(EntryKind::mark)) {
    entry = flow::Mark{};
  } else if (record.is(EntryKind::clutch)) {
    entry = clutch_of(reader);
  } else if (record.is(EntryKind::role)) {
    entry = role_of(reader);
  } else if (record.is(EntryKind::symmetry)) {
    const flow::SetSymmetry symmetry{reader.u8() != 0};
    if (!reader.overrun()) entry = symmetry;
  } else if (record.is(EntryKind::layer)) {
    const std::uint8_t input = reader.u8();
    const flow::SetLayer layer{input, reader.u8() != 0};
    const bool is_layer = input < setup_.hands.size() && setup_.hands[input].layer;
    if (!reader.overrun() && is_layer) entry = layer;
  } else if (record.is(EntryKind::wire)) {
    entry = wire_of(reader);
  } else if (record.is(EntryKind::puppet)) {
    PuppetChange change{reader.u32_le(), nullptr};
    if (const auto known = puppets_.find(change.number); known != puppets_.end())
      change.puppet = known->second;
    if (!reader.overrun()) entry = std::move(change);
  } else if (record.is(EntryKind::gap)) {
    const Gap gap{reader.u64_le()};
    if (!reader.overrun()) entry = gap;
  } else {
    return std::nullopt;
  }
  if (!entry) {
    ++unknown_entries_;
    gap_due_ = true;
  }
  return entry;
}

std::optional<Entry> TakeReader::next() {
  for (;;) {
    if (std::exchange(gap_due_, false)) return Gap{};
    if (const auto record = records_.next()) {
      if (auto entry = entry_of(*record)) return entry;
      continue;
    }
    if (!records_.ended_well()) {
      ++unknown_entries_;
      gap_due_ = true;
    }
    records_ = LogEntries({});
    if (!next_chunk() && !gap_due_) return std::nullopt;
  }
}

} // namespace nendo::recording
