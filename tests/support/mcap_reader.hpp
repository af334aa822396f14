#pragma once
// A reader of MCAP files, written from the format's specification: one that reads them from their
// beginning, as a stream, and one that uses the indices at their end.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <zstd.h>

namespace nendo::test {

/// CRC-32 of IEEE 802.3, bit by bit.
inline std::uint32_t slow_crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xEDB88320 : 0);
  }
  return ~crc;
}

class Mcap {
public:
  using Map = std::map<std::string, std::string>;
  struct Channel {
    std::string topic, schema_name, schema;
    Map metadata;
  };
  struct Message {
    std::string topic;
    std::uint64_t log_ns = 0, publish_ns = 0;
    std::uint32_t sequence = 0;
    std::string data;
    friend bool operator==(const Message&, const Message&) = default;
  };

  std::string profile, library;
  std::map<std::uint16_t, Channel> channels;
  std::vector<Message> messages;
  std::map<std::string, Map> metadata;
  std::size_t chunks = 0;
  bool is_whole = false; ///< it ends as it should
  /// Positions in the file at which chunks end, with the number of messages up to there.
  std::vector<std::pair<std::size_t, std::size_t>> chunk_ends;

  /// Reads up to the last whole record. Throws std::runtime_error where bytes are wrong.
  static Mcap streamed(std::string_view file) {
    Mcap mcap;
    Cursor in{file};
    if (file.size() < magic.size()) return mcap;
    mcap.check(in.take(magic.size()) == magic, "magic");
    while (in.left() >= 9) {
      const auto kind = in.number<std::uint8_t>();
      const auto length = in.number<std::uint64_t>();
      if (length > in.left()) break;
      const std::size_t begin = in.at - 9;
      mcap.read(kind, {in.take(length)}, file.substr(0, begin));
      if (kind == 0x06) mcap.chunk_ends.push_back({in.at, mcap.messages.size()});
      if (kind != 0x02) continue;
      if (in.left() < magic.size()) break;
      mcap.check(in.take(magic.size()) == magic && in.left() == 0, "end");
      mcap.is_whole = true;
      break;
    }
    return mcap;
  }

  /// Reads the messages in that time by the indices alone, sorted by time.
  static Mcap indexed(std::string_view file, std::uint64_t from_ns = 0,
                      std::uint64_t to_ns = UINT64_MAX) {
    Mcap mcap;
    mcap.check(file.size() > 2 * magic.size() + 29 && file.ends_with(magic), "end");
    Cursor footer{file.substr(file.size() - magic.size() - 29, 29)};
    mcap.check(footer.number<std::uint8_t>() == 0x02 && footer.number<std::uint64_t>() == 20,
               "footer");
    const auto summary_at = footer.number<std::uint64_t>();
    const auto offsets_at = footer.number<std::uint64_t>();
    const std::string_view hashed =
        file.substr(summary_at, file.size() - magic.size() - 4 - summary_at);
    mcap.check(footer.number<std::uint32_t>() == slow_crc32(hashed), "checksum of the summary");
    Cursor summary{file.substr(summary_at, offsets_at - summary_at)};
    std::map<std::uint8_t, std::pair<std::uint64_t, std::uint64_t>> groups;
    while (summary.left() > 0) {
      const std::uint64_t at = summary_at + summary.at;
      const auto kind = summary.number<std::uint8_t>();
      const Cursor body{summary.take(summary.number<std::uint64_t>())};
      if (!groups.contains(kind)) groups[kind] = {at, 0};
      groups[kind].second = summary_at + summary.at - groups[kind].first;
      if (kind == 0x08) {
        mcap.read_indexed_chunk(body, file, from_ns, to_ns);
      } else if (kind == 0x0D) {
        mcap.read_indexed_metadata(body, file);
      } else {
        mcap.read(kind, body, {});
      }
    }
    Cursor offsets{file.substr(offsets_at, file.size() - magic.size() - 29 - offsets_at)};
    while (offsets.left() > 0) {
      mcap.check(offsets.number<std::uint8_t>() == 0x0E, "summary offset");
      Cursor body{offsets.take(offsets.number<std::uint64_t>())};
      const auto kind = body.number<std::uint8_t>();
      const auto at = body.number<std::uint64_t>();
      mcap.check(groups.at(kind) == std::pair(at, body.number<std::uint64_t>()), "group's place");
      groups.erase(kind);
    }
    mcap.check(groups.empty(), "groups without an offset");
    std::ranges::stable_sort(mcap.messages, {}, &Message::log_ns);
    return mcap;
  }

  struct Statistics {
    std::uint64_t messages = 0, first_ns = 0, last_ns = 0;
    std::uint32_t schemas = 0, channels = 0, metadata = 0, chunks = 0;
    std::map<std::uint16_t, std::uint64_t> counts;
  } statistics;

private:
  static constexpr std::string_view magic{"\x89MCAP0\r\n", 8};

  struct Cursor {
    std::string_view bytes;
    std::size_t at = 0;

    std::size_t left() const { return bytes.size() - at; }
    std::string_view take(std::uint64_t count) {
      if (count > left()) throw std::runtime_error("a record ends too early");
      at += count;
      return bytes.substr(at - count, count);
    }
    template <class T>
    T number() {
      T value;
      std::memcpy(&value, take(sizeof value).data(), sizeof value);
      return value;
    }
    std::string text() { return std::string(take(number<std::uint32_t>())); }
    Map map() {
      Map read;
      Cursor entries{take(number<std::uint32_t>())};
      while (entries.left() > 0) {
        const std::string key = entries.text();
        read[key] = entries.text();
      }
      return read;
    }
    std::map<std::uint16_t, std::uint64_t> numbers() {
      std::map<std::uint16_t, std::uint64_t> read;
      Cursor entries{take(number<std::uint32_t>())};
      while (entries.left() > 0) {
        const auto key = entries.number<std::uint16_t>();
        read[key] = entries.number<std::uint64_t>();
      }
      return read;
    }
  };

  static void check(bool fine, const char* what) {
    if (!fine) throw std::runtime_error(std::string("MCAP: wrong ") + what);
  }

  struct OpenChunk {
    std::uint64_t first_ns, last_ns;
    std::string compression, records;
  };
  static OpenChunk open_chunk(Cursor body) {
    OpenChunk chunk{};
    chunk.first_ns = body.number<std::uint64_t>();
    chunk.last_ns = body.number<std::uint64_t>();
    const auto size = body.number<std::uint64_t>();
    const auto crc = body.number<std::uint32_t>();
    chunk.compression = body.text();
    const std::string_view stored = body.take(body.number<std::uint64_t>());
    check(body.left() == 0, "chunk");
    chunk.records = stored;
    if (chunk.compression == "zstd") {
      chunk.records.assign(size, '\0');
      check(ZSTD_decompress(chunk.records.data(), size, stored.data(), stored.size()) == size,
            "compression");
    }
    check(chunk.records.size() == size && crc == slow_crc32(chunk.records), "checksum of a chunk");
    return chunk;
  }

  void read(std::uint8_t kind, Cursor body, std::string_view before) {
    switch (kind) {
    case 0x01:
      profile = body.text();
      library = body.text();
      break;
    case 0x03: {
      auto& [name, text] = schemas_[body.number<std::uint16_t>()];
      name = body.text();
      check(body.text() == "ros2msg", "encoding of a schema");
      text = body.text();
      break;
    }
    case 0x04: {
      Channel& channel = channels[body.number<std::uint16_t>()];
      const auto& [name, text] = schemas_.at(body.number<std::uint16_t>());
      channel.schema_name = name;
      channel.schema = text;
      channel.topic = body.text();
      check(body.text() == "cdr", "encoding of messages");
      channel.metadata = body.map();
      break;
    }
    case 0x05:
      messages.push_back(message_in(body));
      return;
    case 0x06: {
      const OpenChunk chunk = open_chunk(body);
      Cursor records{chunk.records};
      while (records.left() > 0) {
        const auto inner = records.number<std::uint8_t>();
        read(inner, {records.take(records.number<std::uint64_t>())}, {});
        const std::uint64_t time_ns = messages.back().log_ns;
        check(time_ns >= chunk.first_ns && time_ns <= chunk.last_ns, "times of a chunk");
      }
      ++chunks;
      return;
    }
    case 0x0B:
      statistics.messages = body.number<std::uint64_t>();
      statistics.schemas = body.number<std::uint16_t>();
      statistics.channels = body.number<std::uint32_t>();
      check(body.number<std::uint32_t>() == 0, "number of attachments");
      statistics.metadata = body.number<std::uint32_t>();
      statistics.chunks = body.number<std::uint32_t>();
      statistics.first_ns = body.number<std::uint64_t>();
      statistics.last_ns = body.number<std::uint64_t>();
      statistics.counts = body.numbers();
      break;
    case 0x0C: {
      const std::string name = body.text();
      metadata[name] = body.map();
      break;
    }
    case 0x0F:
      check(body.number<std::uint32_t>() == slow_crc32(before), "checksum of the data");
      break;
    default:
      return; // indices and the footer, of which a stream has no need
    }
    check(body.left() == 0, "length of a record");
  }

  Message message_in(Cursor body) const {
    Message message;
    message.topic = channels.at(body.number<std::uint16_t>()).topic;
    message.sequence = body.number<std::uint32_t>();
    message.log_ns = body.number<std::uint64_t>();
    message.publish_ns = body.number<std::uint64_t>();
    message.data = body.take(body.left());
    return message;
  }

  void read_indexed_chunk(Cursor body, std::string_view file, std::uint64_t from_ns,
                          std::uint64_t to_ns) {
    ++chunks;
    const auto first_ns = body.number<std::uint64_t>();
    const auto last_ns = body.number<std::uint64_t>();
    if (first_ns > to_ns || last_ns < from_ns) return;
    const auto at = body.number<std::uint64_t>();
    Cursor record{file.substr(at, body.number<std::uint64_t>())};
    check(record.number<std::uint8_t>() == 0x06 && record.number<std::uint64_t>() == record.left(),
          "place of a chunk");
    const OpenChunk chunk = open_chunk({record.take(record.left())});
    check(chunk.first_ns == first_ns && chunk.last_ns == last_ns, "times of a chunk");
    const auto indices = body.numbers();
    check(body.number<std::uint64_t>() > 0 && body.text() == chunk.compression, "chunk index");
    for (const auto& [id, index_at] : indices) {
      Cursor index{file.substr(index_at)};
      check(index.number<std::uint8_t>() == 0x07, "place of a message index");
      Cursor entries{index.take(index.number<std::uint64_t>())};
      check(entries.number<std::uint16_t>() == id, "channel of a message index");
      check(entries.number<std::uint32_t>() == entries.left(), "length of a message index");
      std::uint64_t previous_ns = 0;
      while (entries.left() > 0) {
        const auto time_ns = entries.number<std::uint64_t>();
        Cursor found{std::string_view(chunk.records).substr(entries.number<std::uint64_t>())};
        check(found.number<std::uint8_t>() == 0x05 && time_ns >= previous_ns, "message index");
        previous_ns = time_ns;
        const Message message = message_in({found.take(found.number<std::uint64_t>())});
        check(message.log_ns == time_ns, "time in a message index");
        if (time_ns >= from_ns && time_ns <= to_ns) messages.push_back(message);
      }
    }
  }

  void read_indexed_metadata(Cursor body, std::string_view file) {
    const auto at = body.number<std::uint64_t>();
    Cursor record{file.substr(at, body.number<std::uint64_t>())};
    check(record.number<std::uint8_t>() == 0x0C && record.number<std::uint64_t>() == record.left(),
          "place of metadata");
    read(0x0C, {record.take(record.left())}, {});
    check(metadata.contains(body.text()), "name of metadata");
  }

  std::map<std::uint16_t, std::pair<std::string, std::string>> schemas_;
};

} // namespace nendo::test
