#pragma once
// Writes MCAP (mcap.dev/spec), the file format of recordings of ROS 2, rosbag2 and Foxglove:
// compressed chunks of messages, with indices, statistics and checksums. Does no I/O.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nendo::exporting {

struct McapChannel {
  std::string topic;
  std::string type;   ///< name of the schema; channels of the same type share it
  std::string schema; ///< its text, in the encoding `ros2msg`
  std::vector<std::pair<std::string, std::string>> metadata{};
};

/// Messages are CDR, and may have any times. A chunk is closed when it has chunk_bytes of messages.
/// A reader of a file that was cut off finds all messages of its complete chunks.
class McapWriter {
public:
  static constexpr std::size_t chunk_bytes = std::size_t{1} << 20;
  static constexpr std::size_t max_channels = 1000;

  /// library: names the program in the file. There must be at most max_channels, of different
  /// topics. Allocates.
  McapWriter(std::string_view library, std::vector<McapChannel> channels);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Adds a message of that channel, an index of the constructor's, at a time in nanoseconds since
  /// 1970. Allocates.
  void add(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::byte> message);
  /// Writes the last chunk, and the summary. Only take() may follow.
  void finish();
  /// Returns the next bytes of the file, and forgets them. Empty while a chunk is collected.
  std::vector<std::byte> take();

  std::uint64_t messages() const noexcept;

private:
  class Work;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::exporting
