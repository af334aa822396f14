#pragma once
// Counts the 12-bit records that got lost, by the frames and sub-frames that the others name. A
// second has 30 frames; a frame has as many records as the base rate is a multiple of 30 Hz, and
// sub-frames number them. The check is pure (no I/O, clock, log or allocation) and belongs to one
// thread. It delivers every record: a number that does not fit is no reason to doubt the values.

#include <array>
#include <cstdint>
#include <optional>

#include <nendo/base/units.hpp>

#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

class HiResCheck {
public:
  /// Records after which the numbering is known. None is reported as missed before, and those that
  /// were are reported then.
  static constexpr int learning_records = 32;

  /// `rate_hz` is the base rate that the host has set, or 0: then the sub-frames of the first
  /// records tell it. A glove that leaves out every second record, or more, but always as many,
  /// sends what it was told to.
  explicit HiResCheck(double rate_hz = 0.0) noexcept;

  /// Takes a record that came at `arrival`. Returns the records that were lost before the last one:
  /// whether its own number was right, the record after it tells. Where the seconds of the glove's
  /// clock stand or jump, the time between arrivals tells gaps apart that differ by whole seconds.
  Verdict operator()(const Record& record, HostTime arrival) noexcept;

  /// Returns whether the numbers count records. False at first, and for a glove whose numbers
  /// contradict each other again and again.
  bool tells_missed() const noexcept { return known_ && !given_up_; }

private:
  struct Mark {
    std::uint32_t second = 0;
    std::uint8_t frame = 0;
    std::uint8_t sub_frame = 0;
    HostTime arrival{};
    HostClock::duration lateness{}; ///< by which it came later than the promptest ones
  };

  Verdict learn(const Mark& mark) noexcept;
  Verdict count(Mark mark) noexcept;
  Verdict contradict(const Mark& mark) noexcept;
  std::int64_t steps(const Mark& from, const Mark& to) const noexcept;
  std::int64_t steps_by_arrival(const Mark& from, const Mark& to,
                                std::int64_t difference) const noexcept;
  void accept(Mark& mark, std::int64_t taken) noexcept;
  std::int64_t difference(const Mark& from, const Mark& to) const noexcept;
  std::int64_t in_a_second() const noexcept;
  HostClock::duration time_of(std::int64_t records) const noexcept;

  std::int64_t sub_frames_; ///< in a frame
  std::int64_t stride_ = 1; ///< from one record that is sent to the next
  bool known_ = false;
  bool given_up_ = false;
  bool seconds_stand_ = false; ///< the clock's seconds do not count on, as it seems

  // While the numbering is learnt.
  int learnt_ = 0;
  std::array<int, 10> seen_{}; ///< how often each sub-frame was
  std::array<Mark, learning_records> first_{};

  std::optional<Mark> before_;     ///< the last record but one whose number fitted
  std::optional<Mark> last_;       ///< the last one
  std::int64_t gap_ = 0;           ///< between these two, if the last one's number was right
  std::int64_t strays_before_ = 0; ///< records between these two whose number did not fit
  std::int64_t strays_ = 0;        ///< such records since the last one
  int doubt_ = 0;                  ///< rises with contradictions, falls otherwise
};

} // namespace nendo::driver::cyberglove
