#pragma once
// Splits the byte stream of a 5DT Data Glove 5 into samples, and finds the glove's answer to 'G'.
// It is pure (no I/O, clock, log or allocation), and bytes are not trusted. Nothing marks a
// sample's beginning for certain. So nine bytes are a sample if they begin with the header and
// their checksum fits; otherwise one byte is dropped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <nendo/driver/sample.hpp>

#include "fivedt/fivedt_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::fivedt {

struct Record {
  std::array<std::uint8_t, fingers> flexion{}; ///< thumb to little finger, 0 straight to 255 bent
};

/// Decodes nine bytes. Returns nothing if header or checksum are wrong.
std::optional<Record> decode_record(std::span<const std::byte, sample_bytes> frame) noexcept;

/// A damaged sample counts once as bad, even if many bytes are dropped before the next good one.
class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished sample. The next byte may come from anywhere in a sample.
  void reset() noexcept;

private:
  friend StreamParser;

  std::optional<Record> push_byte(std::byte byte) noexcept;
  void drop_first() noexcept;

  std::array<std::byte, sample_bytes> frame_{};
  bool in_step_ = false;  ///< the last sample was good, and no more than extra bytes came since
  std::size_t extra_ = 0; ///< bytes dropped since the last good sample, while in step
};

/// A glove's answer to the information command.
struct Information {
  Side side = Side::right;
  std::uint8_t version_major = 0;
  std::uint8_t version_minor = 0;
  bool tilt_sensor = false;
  std::string name; ///< printable, without blanks at its ends; may be empty
};

/// Returns nullopt if the answer does not begin as it must.
std::optional<Information> decode_information(std::span<const std::byte, information_bytes> answer);

/// Finds the answer in a glove's bytes, cut anywhere, after a sample or another answer.
class InformationFinder {
public:
  /// Takes the next bytes. Returns true once the whole answer was seen; later bytes are ignored.
  bool push(std::span<const std::byte> chunk) noexcept;
  std::span<const std::byte, information_bytes> answer() const noexcept { return answer_; }

private:
  std::array<std::byte, information_bytes> answer_{};
  std::size_t held_ = 0;
};

} // namespace nendo::driver::fivedt
