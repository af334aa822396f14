#pragma once
// Makes poses of packets of OSC. It is pure (no I/O, clock, log or allocation after construction),
// and bytes are not trusted.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/units.hpp>
#include <nendo/driver/stream_stats.hpp>

#include "osc/osc_packet.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::osc {

inline constexpr std::uint16_t left_station = 1;
inline constexpr std::uint16_t right_station = 2;

/// The addresses of this project, each with seven numbers: x y z in metres, y up, and a quaternion
/// x y z w. All limits are chosen.
inline constexpr std::string_view left_address = "/nendo/wrist/left";
inline constexpr std::string_view right_address = "/nendo/wrist/right";

inline constexpr double max_distance_m = 10.0;  ///< between the sender's origin and the wrist
inline constexpr double max_norm_error = 0.002; ///< the difference of a quaternion's norm from 1
/// Position and rotation in two packets are of one pose if the second comes within this time.
inline constexpr std::chrono::milliseconds max_pair_gap{5};
/// A pose may consist of two packets, one of which is waiting.
inline constexpr std::size_t longest_record = 2 * max_packet_bytes;

/// The addresses of another program, which sends the position (x y z) and the rotation (x y z w) of
/// one wrist as two messages: both in one packet, or one soon after the other, in either order.
struct PairAddresses {
  std::string position;
  std::string rotation;
  std::uint16_t station = left_station;
};

struct Pose {
  std::uint16_t station = left_station;
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{};
  std::optional<std::chrono::nanoseconds> time; ///< as Message::time
};

/// A message of which neither this project nor the options know the address.
struct UnknownAddress {
  std::string_view address;
};

/// Accounts for all bytes: a packet counts as record bytes if one of its messages completes a pose,
/// is pending while a part of a pose in it waits, and is discarded otherwise. Packets that are not
/// OSC, messages with other arguments, with a position that is far or not finite, or with a
/// rotation that is none, and parts of a pose without the other part count as bad.
class Parser {
public:
  Parser() = default;
  explicit Parser(PairAddresses pair) : pair_(std::move(pair)) {}

  /// Takes one packet, or nothing, at `arrival`, which does not decrease. Passes each pose to
  /// `sink(pose)`, and also the other findings, if the sink takes them.
  template <class Sink>
  void push(std::span<const std::byte> packet, HostTime arrival, Sink&& sink) {
    const std::uint64_t bad_before = counters_.bad_records;
    if (begin_packet(packet, arrival)) {
      MessageReader reader(packet);
      while (const auto message = reader.next()) {
        if (const auto pose = take(*message, arrival)) sink(*pose);
        if (!knows(message->address)) report(sink, UnknownAddress{message->address});
      }
      end_packet(packet.size());
    }
    for (std::uint64_t bad = bad_before; bad < counters_.bad_records; ++bad)
      report(sink, BadRecord{});
  }
  /// See StreamCounters::count_discarded.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Returns the bytes of packets in which a part of a pose waits, less than a longest record.
  std::size_t pending() const noexcept { return waiting_.bytes; }

private:
  /// A part of a pose. One of both is there.
  struct Part {
    std::optional<std::array<double, 3>> position_m;
    std::optional<std::array<double, 4>> turn_xyzw;
    HostTime arrival{};
    std::size_t bytes = 0; ///< those of its packet, once that has ended
    bool exists() const noexcept { return position_m || turn_xyzw; }
  };

  bool begin_packet(std::span<const std::byte> packet, HostTime arrival) noexcept;
  void end_packet(std::size_t bytes) noexcept;
  bool knows(std::string_view address) const noexcept;
  std::optional<Pose> take(const Message& message, HostTime arrival) noexcept;
  std::optional<Pose> take_whole(const Message& message) noexcept;
  std::optional<Pose> take_part(const Message& message, HostTime arrival) noexcept;
  void drop_waiting_part() noexcept;

  PairAddresses pair_;
  Part waiting_;
  // Of the packet that is being read:
  bool completed_pose_ = false;
  bool has_waiting_part_ = false;

  StreamCounters counters_;
};

} // namespace nendo::driver::osc
