#pragma once
// Checks whether well-formed records agree with those before them: RecordCheck by time stamps and
// status bytes, HiResCheck by the frames of 12-bit records. Both are pure (no I/O, clock, log or
// allocation) and belong to one thread.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <nendo/base/units.hpp>

#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

/// How punctually a device takes its time stamps, learnt from the gaps between them. So the jitter
/// of a good device costs no record, and a wrong stamp of a punctual one is noticed.
class StampJitter {
public:
  /// Learns from a gap between two stamps, of a glove that is set to `period`. Call it before
  /// allows(): stamps that begin to wander then widen the tolerance rather than be refused.
  void learn(std::uint32_t gap, std::uint32_t period) noexcept;
  /// Returns true if the gap is a whole number of periods, within this device's jitter.
  bool allows(std::uint32_t gap, std::uint32_t period) const noexcept;
  /// Returns true if the stamps wander so much that the period does not count as kept.
  bool hides(std::uint32_t period) const noexcept;
  /// Starts again, because the device has another period.
  void forget() noexcept { *this = {}; }

private:
  std::uint64_t mean() const noexcept; ///< deviation from whole periods, in ticks

  std::uint32_t known_ = 0; ///< number of learnt deviations, while they are few
  std::uint64_t sum_ = 0;   ///< sum of the last deviations, in 1/256 tick
};

/// The protocol has no checksum. Its redundancy is the time stamp, which must advance by whole
/// periods, and the status byte, most of which is constant.
///
/// The effect of a flipped bit in a record of 22 sensors, time stamp and status (30 bytes, 240
/// bits) at 100 records per second (1152 ticks), if none of its bytes is a power of two and the
/// stamps are punctual:
///   caught    50: header 8, flags of the time stamp 4, ticks 24, status 6, NUL 8
///   harmless   4: the flags' upper half means nothing; what is delivered is right
///   delivered 186: sensors 176, the 8 ticks' bits below the tolerance, wrist switch and light 2
/// So 78 % of the flips are not found. Nothing can check a sensor's bit, unless it was the only bit
/// set in its byte, so that the flip makes a NUL. While no period is known, a stamp may be wrong by
/// half a period. FAULTS.md has a table of the losses by jitter of the stamps.
class RecordCheck {
public:
  /// `period_ticks` is the period to which the glove is set. It is 0 if the period is unknown or as
  /// short as possible; it is then learnt, and need not be kept closely.
  explicit RecordCheck(std::uint64_t period_ticks = 0) noexcept;

  /// Checks a record, for Parser::push. While the glove keeps its period, records sent = delivered
  /// + missed at every plausible record. A gap of more than 16 periods, a restarted clock or
  /// another period is accepted at the third record that agrees with the two before it. If stamps
  /// contradict each other repeatedly, first the period need not be kept closely, and then the
  /// stamps are ignored and the records pass with Stamp::none. A stamp may err by a sixteenth of a
  /// period at any time, and by more as soon as the device has shown that its stamps do, so that
  /// the jitter of a good device costs no record. Stamp::begins marks ticks that do not continue
  /// the previous ones.
  Verdict operator()(Record& record) noexcept;

  /// Returns the period that was given or learnt; 0 while it is unknown.
  std::uint32_t period_ticks() const noexcept { return period_; }
  /// Returns whether the stamps make sense. If not, the number of missed records is unknown.
  bool trusts_stamps() const noexcept { return trusted_; }

private:
  /// From one record to the next.
  struct Step {
    std::uint32_t gap;
    bool was_late; ///< the glove reported that it sampled the first one off its period
    bool is_late;
  };
  /// Records in a row that contradict the accepted ones, but may agree with each other.
  struct Suspects {
    int count = 0; ///< up to 2
    std::uint32_t ticks = 0;
    bool late = false;
    Step step{}; ///< from the first to the second
  };

  bool status_agrees(std::uint8_t status) noexcept;
  Verdict check_stamp(Record& record) noexcept;
  Verdict refuse() noexcept;
  Verdict accept(const Record& record, std::uint64_t missed) noexcept;
  std::uint32_t agreed_period(const Record& record) noexcept;
  Verdict begin_again(Record& record, std::uint32_t agreed) noexcept;
  Verdict lose_trust(Record& record) noexcept;
  std::uint32_t periods(const Step& step) const noexcept;
  bool keeps_period(const Step& step) const noexcept;
  void learn_jitter(const Step& step) noexcept;
  std::uint32_t steady_periods(const Step& step) const noexcept;
  std::uint64_t follow(const Step& step, std::uint32_t count) noexcept;
  std::uint64_t learn(std::uint32_t gap) noexcept;
  std::uint32_t max_gap() const noexcept;

  // The clock.
  std::uint32_t period_;
  bool steady_;         ///< the period is kept closely, but for late records
  bool trusted_ = true; ///< the stamps make sense
  bool begun_ = false;
  std::uint32_t last_ticks_ = 0;
  bool last_late_ = false;
  StampJitter jitter_;
  std::uint32_t late_pace_ = 0;         ///< between late records, 0 while unknown
  std::array<std::uint32_t, 8> gaps_{}; ///< the first gaps, while a period is learnt
  std::size_t gap_count_ = 0;
  std::uint64_t learnt_missed_ = 0; ///< records missed in these gaps, and counted
  int doubt_ = 0;                   ///< rises with refusals, falls with acceptances
  std::uint64_t refused_ = 0;       ///< since the last accepted record
  Suspects suspects_;

  // The status byte.
  bool status_known_ = false;
  std::uint8_t status_constant_ = 0;
  std::uint8_t status_suspect_ = 0;
  int status_suspects_ = 0;
};

/// Counts lost 12-bit records by the frames and sub-frames of the others. A second has 30 frames; a
/// frame has as many records as the base rate is a multiple of 30 Hz, and sub-frames number them.
/// Every record is plausible: a number that does not fit is no reason to doubt the values.
class HiResCheck {
public:
  /// Records after which the numbering is known. Earlier missed records are reported then.
  static constexpr int learning_records = 32;

  /// `rate_hz` is the base rate that the host has set, or 0: then the sub-frames of the first
  /// records show it. A glove that always leaves out the same number of records is set to do so.
  explicit HiResCheck(double rate_hz = 0.0) noexcept;

  /// Takes a record that came at `arrival`. Returns the records that were lost before the previous
  /// one, because only this one shows whether its number was right. If the seconds of the glove's
  /// clock stop or jump, the time between arrivals decides between gaps that differ by whole
  /// seconds.
  Verdict operator()(const Record& record, HostTime arrival) noexcept;

  /// Returns whether the numbers count records. False at first, and for a glove whose numbers
  /// contradict each other again and again.
  bool counts_missed() const noexcept { return known_ && !given_up_; }

private:
  struct Mark {
    std::uint32_t second = 0;
    std::uint8_t frame = 0;
    std::uint8_t sub_frame = 0;
    HostTime arrival{};
    HostClock::duration lateness{}; ///< delay against the promptest records
  };

  Verdict learn(const Mark& mark) noexcept;
  Verdict count(Mark mark) noexcept;
  Verdict contradict(const Mark& mark) noexcept;
  std::int64_t steps(const Mark& from, const Mark& to) const noexcept;
  std::int64_t steps_by_arrival(const Mark& from, const Mark& to,
                                std::int64_t difference) const noexcept;
  void accept(Mark& mark, std::int64_t taken) noexcept;
  std::int64_t difference(const Mark& from, const Mark& to) const noexcept;
  std::int64_t per_second() const noexcept;
  HostClock::duration time_of(std::int64_t records) const noexcept;

  std::int64_t sub_frames_; ///< sub-frames per frame
  std::int64_t stride_ = 1; ///< sub-frames from one record to the next
  bool known_ = false;
  bool given_up_ = false;
  bool seconds_stopped_ = false; ///< the clock's seconds seem to have stopped

  // While the numbering is learnt.
  int learnt_ = 0;
  std::array<int, 10> seen_{}; ///< number of records per sub-frame
  std::array<Mark, learning_records> first_{};

  std::optional<Mark> before_;     ///< the last but one record whose number fitted
  std::optional<Mark> last_;       ///< the last such record
  std::int64_t gap_ = 0;           ///< between these two, if the last one's number was right
  std::int64_t strays_before_ = 0; ///< records between these two whose number did not fit
  std::int64_t strays_ = 0;        ///< such records since the last one
  int doubt_ = 0;                  ///< rises with contradictions, falls otherwise
};

} // namespace nendo::driver::cyberglove
