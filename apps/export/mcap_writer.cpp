#include "export/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include <zlib.h>
#include <zstd.h>

#include <nendo/base/byte_writer.hpp>

namespace nendo::exporting {
namespace {

using Bytes = std::vector<std::byte>;

/// The records of the format, by their opcodes.
enum class Record : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

constexpr std::array<std::uint8_t, 8> mcap_magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr int compression_level = 1; // others take longer, and save a tenth at most

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before = 0) noexcept {
  if (bytes.empty()) return before; // zlib begins again for a null pointer
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// Appends a record's head, and its length when the body is complete.
class OpenRecord {
public:
  OpenRecord(Record kind, Bytes& out) : body(out), out_(out) {
    body.u8(static_cast<std::uint8_t>(kind));
    body.u64_le(0);
    begin_ = out.size();
  }
  ~OpenRecord() {
    for (std::size_t at = 0, rest = out_.size() - begin_; at < 8; ++at, rest >>= 8U)
      out_[begin_ - 8 + at] = static_cast<std::byte>(rest & 0xFFU);
  }
  OpenRecord(const OpenRecord&) = delete;
  OpenRecord& operator=(const OpenRecord&) = delete;

  void text(std::string_view text) {
    body.u32_le(static_cast<std::uint32_t>(text.size()));
    body.bytes(std::as_bytes(std::span(text)));
  }
  void map(std::span<const std::pair<std::string, std::string>> entries) {
    std::size_t bytes = 0;
    for (const auto& [key, value] : entries)
      bytes += 8 + key.size() + value.size();
    body.u32_le(static_cast<std::uint32_t>(bytes));
    for (const auto& [key, value] : entries) {
      text(key);
      text(value);
    }
  }
  /// A map from the channels' ids to numbers. Zeros are left out.
  void map(std::span<const std::uint64_t> of_channels) {
    constexpr std::size_t entry_bytes = 2 + 8;
    const auto used = of_channels.size() -
                      static_cast<std::size_t>(std::ranges::count(of_channels, std::uint64_t{0}));
    body.u32_le(static_cast<std::uint32_t>(entry_bytes * used));
    for (std::size_t channel = 0; channel < of_channels.size(); ++channel) {
      if (of_channels[channel] == 0) continue;
      body.u16_le(static_cast<std::uint16_t>(channel));
      body.u64_le(of_channels[channel]);
    }
  }

  ByteWriter body;

private:
  Bytes& out_;
  std::size_t begin_ = 0;
};

/// The first and the last time of messages.
struct Times {
  std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;

  void add(std::uint64_t time_ns) noexcept {
    first_ns = std::min(first_ns, time_ns);
    last_ns = std::max(last_ns, time_ns);
  }
  void put(ByteWriter& body) const { // both are 0 without a message
    body.u64_le(std::min(first_ns, last_ns));
    body.u64_le(last_ns);
  }
};

// rosbag2 expects profiles with numbers, as in ros::offered_qos_profiles(), of a file that says
// this. It reads those of a file that says nothing as names since Jazzy, and as numbers before.
const std::vector<std::pair<std::string, std::string>> of_rosbag2{{"ROS_DISTRO", "humble"}};
constexpr std::string_view metadata_name = "rosbag2";

} // namespace

class McapWriter::Work {
public:
  Work(std::string_view library, std::vector<McapChannel> channels)
      : channels_(std::move(channels)), counts_(channels_.size()), indices_(channels_.size()) {
    put_magic();
    {
      OpenRecord header(Record::header, out_);
      header.text("ros2");
      header.text(library);
    }
    metadata_at_ = out_.size();
    {
      OpenRecord metadata(Record::metadata, out_);
      metadata.text(metadata_name);
      metadata.map(of_rosbag2);
    }
    metadata_bytes_ = out_.size() - metadata_at_;
    // Before the first chunk: a reader without the summary must know them.
    put_schemas();
    put_channels();
  }

  void add(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::byte> message) {
    indices_[channel].push_back({time_ns, chunk_.size()});
    {
      OpenRecord record(Record::message, chunk_);
      record.body.u16_le(channel);
      record.body.u32_le(static_cast<std::uint32_t>(counts_[channel]++));
      record.body.u64_le(time_ns);
      record.body.u64_le(time_ns);
      record.body.bytes(message);
    }
    chunk_times_.add(time_ns);
    if (chunk_.size() >= chunk_bytes) close_chunk();
  }

  void finish() {
    if (!chunk_.empty()) close_chunk();
    hash_file();
    {
      OpenRecord end(Record::data_end, out_);
      end.body.u32_le(file_crc_);
    }
    put_summary();
    put_magic();
  }

  Bytes take() {
    hash_file();
    taken_ += out_.size();
    hashed_ = 0;
    return std::exchange(out_, {});
  }

  std::uint64_t messages() const noexcept {
    std::uint64_t all = 0;
    for (const std::uint64_t count : counts_)
      all += count;
    return all;
  }

private:
  struct IndexEntry {
    std::uint64_t time_ns;
    std::uint64_t offset; ///< in the chunk
  };
  struct ChunkEntry {
    Times times;
    std::uint64_t at, bytes;
    std::vector<std::uint64_t> indices_at; ///< index: channel; 0: it has no message here
    std::uint64_t indices_bytes;
    std::string_view compression;
    std::uint64_t compressed_bytes, uncompressed_bytes;
  };

  std::uint64_t position() const noexcept { return taken_ + out_.size(); }
  void put_magic() {
    out_.insert(out_.end(), std::as_bytes(std::span(mcap_magic)).begin(),
                std::as_bytes(std::span(mcap_magic)).end());
  }
  /// Includes all bytes so far in the checksum of the data.
  void hash_file() {
    file_crc_ = crc32_of(std::span(out_).subspan(hashed_), file_crc_);
    hashed_ = out_.size();
  }
  /// Ids of schemas begin at 1. Channels of one type have the id of the first of them.
  std::uint16_t schema_id(const McapChannel& channel) const {
    const auto first = std::ranges::find(channels_, channel.type, &McapChannel::type);
    return static_cast<std::uint16_t>(first - channels_.begin() + 1);
  }
  bool owns_schema(std::size_t channel) const {
    return schema_id(channels_[channel]) == channel + 1;
  }

  void put_schemas() {
    for (std::size_t at = 0; at < channels_.size(); ++at) {
      if (!owns_schema(at)) continue;
      OpenRecord schema(Record::schema, out_);
      schema.body.u16_le(schema_id(channels_[at]));
      schema.text(channels_[at].type);
      schema.text("ros2msg");
      schema.text(channels_[at].schema);
    }
  }
  void put_channels() {
    for (std::size_t at = 0; at < channels_.size(); ++at) {
      OpenRecord channel(Record::channel, out_);
      channel.body.u16_le(static_cast<std::uint16_t>(at));
      channel.body.u16_le(schema_id(channels_[at]));
      channel.text(channels_[at].topic);
      channel.text("cdr");
      channel.map(channels_[at].metadata);
    }
  }

  /// Returns the compressed chunk. Without memory for that, the chunk itself.
  std::span<const std::byte> compress(ChunkEntry& entry) {
    entry.uncompressed_bytes = chunk_.size();
    compressed_.resize(ZSTD_compressBound(chunk_.size()));
    const std::size_t bytes = ZSTD_compress(compressed_.data(), compressed_.size(), chunk_.data(),
                                            chunk_.size(), compression_level);
    if (ZSTD_isError(bytes) != 0) return chunk_;
    entry.compression = "zstd";
    return std::span(compressed_).first(bytes);
  }

  void close_chunk() {
    ChunkEntry entry{};
    entry.times = std::exchange(chunk_times_, {});
    const std::span<const std::byte> records = compress(entry);
    entry.compressed_bytes = records.size();
    entry.at = position();
    {
      OpenRecord chunk(Record::chunk, out_);
      entry.times.put(chunk.body);
      chunk.body.u64_le(chunk_.size());
      chunk.body.u32_le(crc32_of(chunk_));
      chunk.text(entry.compression);
      chunk.body.u64_le(records.size());
      chunk.body.bytes(records);
    }
    entry.bytes = position() - entry.at;
    put_message_indices(entry);
    times_.add(entry.times.first_ns);
    times_.add(entry.times.last_ns);
    chunks_.push_back(std::move(entry));
    chunk_.clear();
  }

  void put_message_indices(ChunkEntry& entry) {
    const std::uint64_t begin = position();
    entry.indices_at.resize(channels_.size());
    for (std::size_t at = 0; at < indices_.size(); ++at) {
      if (indices_[at].empty()) continue;
      entry.indices_at[at] = position();
      std::ranges::stable_sort(indices_[at], {}, &IndexEntry::time_ns);
      OpenRecord index(Record::message_index, out_);
      index.body.u16_le(static_cast<std::uint16_t>(at));
      index.body.u32_le(static_cast<std::uint32_t>(16 * indices_[at].size()));
      for (const IndexEntry& one : indices_[at]) {
        index.body.u64_le(one.time_ns);
        index.body.u64_le(one.offset);
      }
      indices_[at].clear();
    }
    entry.indices_bytes = position() - begin;
  }

  void put_statistics() {
    OpenRecord statistics(Record::statistics, out_);
    std::uint16_t schemas = 0;
    for (std::size_t at = 0; at < channels_.size(); ++at)
      schemas = static_cast<std::uint16_t>(schemas + (owns_schema(at) ? 1 : 0));
    statistics.body.u64_le(messages());
    statistics.body.u16_le(schemas);
    statistics.body.u32_le(static_cast<std::uint32_t>(channels_.size()));
    statistics.body.u32_le(0); // attachments
    statistics.body.u32_le(1); // metadata
    statistics.body.u32_le(static_cast<std::uint32_t>(chunks_.size()));
    times_.put(statistics.body);
    statistics.map(counts_);
  }
  void put_chunk_indices() {
    for (const ChunkEntry& chunk : chunks_) {
      OpenRecord index(Record::chunk_index, out_);
      chunk.times.put(index.body);
      index.body.u64_le(chunk.at);
      index.body.u64_le(chunk.bytes);
      index.map(chunk.indices_at);
      index.body.u64_le(chunk.indices_bytes);
      index.text(chunk.compression);
      index.body.u64_le(chunk.compressed_bytes);
      index.body.u64_le(chunk.uncompressed_bytes);
    }
  }
  void put_metadata_index() {
    OpenRecord index(Record::metadata_index, out_);
    index.body.u64_le(metadata_at_);
    index.body.u64_le(metadata_bytes_);
    index.text(metadata_name);
  }

  /// Writes the groups of the summary, their offsets, and the footer.
  void put_summary() {
    struct Group {
      Record kind;
      void (Work::*put)();
      std::uint64_t at = 0, bytes = 0;
    };
    std::array groups{Group{Record::schema, &Work::put_schemas},
                      Group{Record::channel, &Work::put_channels},
                      Group{Record::statistics, &Work::put_statistics},
                      Group{Record::chunk_index, &Work::put_chunk_indices},
                      Group{Record::metadata_index, &Work::put_metadata_index}};
    const std::size_t begin = out_.size();
    const std::uint64_t summary_at = position();
    for (Group& group : groups) {
      group.at = position();
      (this->*group.put)();
      group.bytes = position() - group.at;
    }
    const std::uint64_t offsets_at = position();
    for (const Group& group : groups) {
      if (group.bytes == 0) continue;
      OpenRecord offset(Record::summary_offset, out_);
      offset.body.u8(static_cast<std::uint8_t>(group.kind));
      offset.body.u64_le(group.at);
      offset.body.u64_le(group.bytes);
    }
    ByteWriter footer(out_);
    footer.u8(static_cast<std::uint8_t>(Record::footer));
    footer.u64_le(8 + 8 + 4);
    footer.u64_le(summary_at);
    footer.u64_le(offsets_at);
    footer.u32_le(crc32_of(std::span(out_).subspan(begin))); // up to here
  }

  std::vector<McapChannel> channels_;
  std::vector<std::uint64_t> counts_;            ///< messages, index: channel
  std::vector<std::vector<IndexEntry>> indices_; ///< entries of the open chunk, index: channel
  Bytes out_;                                    ///< bytes that take() has not returned
  std::size_t hashed_ = 0;
  std::uint32_t file_crc_ = 0;
  std::uint64_t taken_ = 0;
  Bytes chunk_, compressed_;
  Times chunk_times_, times_;
  std::vector<ChunkEntry> chunks_;
  std::uint64_t metadata_at_ = 0, metadata_bytes_ = 0;
};

McapWriter::McapWriter(std::string_view library, std::vector<McapChannel> channels)
    : work_(std::make_unique<Work>(library, std::move(channels))) {}
McapWriter::~McapWriter() = default;

void McapWriter::add(std::uint16_t channel, std::uint64_t time_ns,
                     std::span<const std::byte> message) {
  work_->add(channel, time_ns, message);
}
void McapWriter::finish() {
  work_->finish();
}
std::vector<std::byte> McapWriter::take() {
  return work_->take();
}
std::uint64_t McapWriter::messages() const noexcept {
  return work_->messages();
}

} // namespace nendo::exporting
