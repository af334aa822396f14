#pragma once
// Cuts the stream of `nendo serve` into lines, and picks the samples of one device. Pure, but it
// allocates, see served_lines.hpp.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include <nendo/base/units.hpp>

#include "served/served_lines.hpp"
#include "served/served_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::served {

/// The device whose samples are records.
struct WantedDevice {
  enum class Kind : std::uint8_t { none, glove, tracker } kind = Kind::none;
  std::uint32_t index = 0; ///< as the server counts
};

/// Whole lines that are no record are discarded, and not bad.
class Parser : public StreamParser<Parser> {
public:
  /// Takes the next bytes of the stream, cut anywhere, and passes to `sink(finding)`, in the order
  /// of the stream: each GloveSample or PoseSample of the wanted device, and the findings that the
  /// sink takes: VersionLine, GloveLine, TrackerLine, WatchLine, ErrorLine, BadRecord.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      ++counters_.bytes;
      const auto finding = push_byte(byte);
      report_bad(sink);
      if (finding) std::visit([&](const auto& found) { report(sink, found); }, *finding);
    }
  }

  /// Sets the device whose samples are records, from the server's next answer on that says that
  /// samples follow. Until then, all samples are discarded.
  void want(const WantedDevice& device) noexcept;
  /// Sets the time at which the next bytes arrived. Samples that came later, or more than max_age
  /// earlier, or were measured more than that from their arrival, are bad. Initially any are good.
  void set_arrival(HostTime now) noexcept { now_ = now; }
  /// Drops the unfinished line, for a new connection, which begins with a line.
  void reset() noexcept;

private:
  friend StreamParser;

  using Finding = std::variant<VersionLine, GloveLine, TrackerLine, WatchLine, ErrorLine,
                               GloveSample, PoseSample>;

  std::optional<Finding> push_byte(std::byte byte);
  std::optional<Finding> end_line();
  std::optional<Finding> found(const Line& line);
  template <class Sample>
  std::optional<Finding> found(const Sample& sample, const WantedDevice& device,
                               std::uint64_t dropped) noexcept;
  template <class Sample>
  bool is_of_this_time(const Sample& sample) const noexcept;

  WantedDevice wanted_;
  bool follows_ = false;     ///< the server has answered that samples follow
  bool is_overlong_ = false; ///< the rest of the line is discarded
  std::optional<HostTime> now_;
  std::array<char, max_line_bytes> line_{};
};

} // namespace nendo::driver::served
