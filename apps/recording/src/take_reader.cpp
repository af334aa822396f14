#include <nendo/recording/take_reader.hpp>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <nendo/base/byte_reader.hpp>

#include "setup_parts.hpp"

namespace nendo::recording {
namespace {

/// What an entry has in a file: its kind, the size of its body, and the body's fields.
template <class One>
struct Format;
template <EntryKind of_entry, std::size_t of_body>
struct FormatOf {
  static constexpr EntryKind kind = of_entry;
  static constexpr std::size_t bytes = of_body;
};

template <>
struct Format<RecordedSample> : FormatOf<EntryKind::sample, sample_bytes> {
  static void put(auto& fields, auto& sample) { sample_body(fields, sample); }
};

template <>
struct Format<RecordedPose> : FormatOf<EntryKind::pose, pose_bytes> {
  static void put(auto& fields, auto& recorded) { pose_body(fields, recorded); }
};

template <>
struct Format<flow::Recentre> : FormatOf<EntryKind::recentre, 0> {
  static void put(auto& /*fields*/, auto& /*recentre*/) {}
};

template <>
struct Format<flow::LoopSettings> : FormatOf<EntryKind::settings, settings_bytes> {
  static void put(auto& fields, auto& settings) { settings_body(fields, settings); }
};

template <>
struct Format<flow::Request> : FormatOf<EntryKind::request, 1> {
  static void put(auto& fields, auto& request) { fields.one_of(request, flow::Request::regrab); }
};

template <>
struct Format<flow::LoggedTick> : FormatOf<EntryKind::tick, 24> {
  static void put(auto& fields, auto& tick) {
    fields.u64(tick.number);
    fields.time(tick.scheduled);
    fields.time(tick.woke);
  }
};

template <>
struct Format<flow::WristMove> : FormatOf<EntryKind::wrist, 57> {
  static void put(auto& fields, auto& move) {
    fields.one_of(move.side, Side::right);
    for (auto& number : move.position_m)
      fields.number(number);
    for (auto& number : move.turn_xyzw)
      fields.number(number);
    fields.require(move.is_usable());
  }
};

template <>
struct Format<flow::HoldStill> : FormatOf<EntryKind::hold_still, 0> {
  static void put(auto& /*fields*/, auto& /*still*/) {}
};

template <>
struct Format<flow::ChangeModel> : FormatOf<EntryKind::model, 21> {
  static void put(auto& fields, auto& change) {
    fields.u32(change.number);
    fields.one_of(change.source, flow::ModelSource::topology);
    fields.u32(change.max_vertices);
    fields.number(change.seam_width, 0.0, std::numeric_limits<double>::max());
    fields.u32(change.part);
  }
};

template <>
struct Format<flow::Mark> : FormatOf<EntryKind::mark, 0> {
  static void put(auto& /*fields*/, auto& /*mark*/) {}
};

template <>
struct Format<flow::SetClutch> : FormatOf<EntryKind::clutch, 3> {
  static void put(auto& fields, auto& clutch) {
    fields.one_of(clutch.side, Side::right);
    fields.u8(clutch.finger);
    fields.flag(clutch.holds);
  }
};

template <>
struct Format<flow::SetRole> : FormatOf<EntryKind::role, 4> {
  static void put(auto& fields, auto& role) {
    fields.u16(role.function);
    fields.signal(role.input);
  }
};

template <>
struct Format<flow::SetSymmetry> : FormatOf<EntryKind::symmetry, 1> {
  static void put(auto& fields, auto& symmetry) { fields.flag(symmetry.on); }
};

template <>
struct Format<flow::SetLayer> : FormatOf<EntryKind::layer, 2> {
  static void put(auto& fields, auto& layer) {
    fields.u8(layer.input);
    fields.flag(layer.on);
  }
};

template <>
struct Format<flow::DrawWire> : FormatOf<EntryKind::wire, 1> {
  static void put(auto& fields, auto& wire) {
    auto blade = static_cast<std::uint8_t>(wire.on ? 1U + static_cast<unsigned>(wire.blade) : 0U);
    fields.u8(blade);
    fields.require(blade <= 1U + static_cast<unsigned>(flow::Blade::knife));
    if constexpr (std::remove_cvref_t<decltype(fields)>::reads) {
      wire.on = blade > 0;
      if (wire.on) wire.blade = static_cast<flow::Blade>(blade - 1U);
    }
  }
};

template <>
struct Format<PuppetChange> : FormatOf<EntryKind::puppet, 4> {
  static void put(auto& fields, auto& change) { fields.u32(change.number); }
};

template <>
struct Format<Gap> : FormatOf<EntryKind::gap, 8> {
  static void put(auto& fields, auto& gap) { fields.u64(gap.entries); }
};

/// Returns nothing if the entry's body is not usable.
template <class One>
std::optional<Entry> read_entry(const LogEntry& record) {
  return read_value<One>(record.body, Format<One>::template put<FieldReader, One>);
}

using EntryReader = std::optional<Entry> (*)(const LogEntry& record);

/// Returns null if the entry is none of the variant's types.
template <class... Types>
EntryReader reader_of(const LogEntry& record, std::type_identity<std::variant<Types...>>) {
  EntryReader found = nullptr;
  ((found = record.is(Format<Types>::kind) ? read_entry<Types> : found), ...);
  return found;
}

void ending_fields(auto& fields, auto& ending) {
  fields.time(ending.host);
  for (auto* const count : {&ending.samples, &ending.requests, &ending.ticks, &ending.lost})
    fields.u64(*count);
  bool has_shape = ending.shape.has_value();
  ShapeSum shape = ending.shape.value_or(ShapeSum{});
  fields.flag(has_shape);
  fields.u64(shape.vertices);
  fields.u32(shape.crc);
  if constexpr (std::remove_cvref_t<decltype(fields)>::reads)
    if (has_shape) ending.shape = shape;
}

void sent_fields(auto& fields, auto& gloves) {
  for (auto& counts : gloves)
    for (auto* const count : {&counts.delivered, &counts.missed, &counts.refused, &counts.bad})
      fields.u64(*count);
  for (auto& counts : gloves) {
    fields.flag(counts.counts_missed);
    fields.u64(counts.clamped);
  }
}

std::optional<std::vector<driver::RecordCounts>> sent_of(std::span<const std::byte> payload) {
  return read_value<std::vector<driver::RecordCounts>>(payload, [](auto& fields, auto& gloves) {
    std::uint8_t count = 0;
    fields.u8(count);
    gloves.resize(count);
    sent_fields(fields, gloves);
  });
}

} // namespace

void put_entry(ByteWriter& writer, const Entry& entry) {
  std::visit(
      [&]<class One>(const One& one) {
        writer.u8(static_cast<std::uint8_t>(Format<One>::kind));
        writer.u8(static_cast<std::uint8_t>(Format<One>::bytes));
        FieldWriter fields(writer);
        Format<One>::put(fields, one);
      },
      entry);
}

void put_ending(ByteWriter& writer, const Ending& ending) {
  FieldWriter fields(writer);
  ending_fields(fields, ending);
}

void put_sent(ByteWriter& writer, std::span<const driver::RecordCounts> gloves) {
  FieldWriter fields(writer);
  writer.u8(static_cast<std::uint8_t>(gloves.size()));
  sent_fields(fields, gloves);
}

TakeReader::TakeReader(ChunkReader chunks) : chunks_(std::move(chunks)) {
  next_chunk(); // the setup precedes the first input log
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
    ending_ = read_value<Ending>(chunk.payload, ending_fields<FieldReader, Ending>);
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
  const EntryReader read = reader_of(record, std::type_identity<Entry>());
  if (read == nullptr) return std::nullopt;
  std::optional<Entry> entry = read(record);
  if (auto* const change = entry ? std::get_if<PuppetChange>(&*entry) : nullptr) {
    if (const auto known = puppets_.find(change->number); known != puppets_.end())
      change->puppet = known->second;
  } else if (const auto* const layer = entry ? std::get_if<flow::SetLayer>(&*entry) : nullptr) {
    if (layer->input >= setup_.hands.size() || !setup_.hands[layer->input].layer) entry.reset();
  } else if (const auto* const sample = entry ? std::get_if<RecordedSample>(&*entry) : nullptr) {
    if (sample->glove >= setup_.gloves.size()) entry.reset();
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

RecordedShape shape_of(std::uint64_t tick, const deform::Points& vertices) {
  RecordedShape shape;
  shape.tick = tick;
  shape.xyz.resize(static_cast<std::size_t>(vertices.size()));
  Eigen::Matrix3Xf::Map(shape.xyz.data(), 3, vertices.cols()) = vertices.cast<float>();
  return shape;
}

void put_shape(ByteWriter& writer, const RecordedShape& shape) {
  assert(shape.xyz.size() <= 3 * max_recorded_vertices);
  writer.u64_le(shape.tick);
  writer.u32_le(static_cast<std::uint32_t>(shape.xyz.size() / 3));
  for (const float coordinate : shape.xyz)
    writer.u32_le(std::bit_cast<std::uint32_t>(coordinate));
}

std::optional<RecordedShape> read_shape(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  RecordedShape shape;
  shape.tick = reader.u64_le();
  const std::size_t vertices = reader.u32_le();
  if (reader.overrun() || 12 + 12 * vertices > payload.size()) return std::nullopt;
  shape.xyz.resize(3 * vertices);
  for (float& coordinate : shape.xyz)
    coordinate = std::bit_cast<float>(reader.u32_le());
  if (!std::ranges::all_of(shape.xyz, [](float number) { return std::isfinite(number); }))
    return std::nullopt;
  return shape;
}

std::optional<double> distance_between(const RecordedShape& shape, const deform::Points& vertices) {
  if (static_cast<Eigen::Index>(shape.xyz.size()) != vertices.size()) return std::nullopt;
  if (vertices.cols() == 0) return 0.0;
  const auto recorded = Eigen::Matrix3Xf::Map(shape.xyz.data(), 3, vertices.cols());
  return (recorded.cast<double>() - vertices).colwise().norm().maxCoeff();
}

} // namespace nendo::recording
