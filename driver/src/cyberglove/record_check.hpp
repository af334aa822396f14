#pragma once
// Checks whether a well-formed record agrees with those before it. The protocol has no checksum.
// Its redundancy is the time stamp, which must advance by whole periods, and the status byte, most
// of which is constant. The check is pure (no I/O, clock, log or allocation) and belongs to one
// thread.
//
// The effect of a flipped bit in a record of 22 sensors, time stamp and status (30 bytes, 240 bits)
// at 100 records a second (1152 ticks), if none of its bytes is a power of two and the stamps are
// punctual:
//   caught    50: header 8, flags of the time stamp 4, ticks 24, status 6, NUL 8
//   harmless   4: the flags' upper half means nothing; what is delivered is right
//   delivered 186: sensors 176, the 8 ticks' bits below the tolerance, wrist switch and light 2
// So 78 % of the flips are not found. Nothing can check a sensor's bit, unless it was the only bit
// set in its byte, so that the flip makes a NUL. While no period is known, a stamp may be wrong by
// half a period. FAULTS.md has a table of what jitter of the stamps costs.

#include <array>
#include <cstddef>
#include <cstdint>

#include "cyberglove/cyberglove_parser.hpp"
#include "cyberglove/stamp_jitter.hpp"

namespace nendo::driver::cyberglove {

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
  /// the jitter of a good device costs no record. Stamp::begins marks ticks that do
  /// not continue those before them.
  Verdict operator()(Record& record) noexcept;

  /// Returns the period that was given or learnt; 0 while it is unknown.
  std::uint32_t period_ticks() const noexcept { return period_; }
  /// Returns whether the stamps make sense. If not, nobody knows what was missed.
  bool trusts_stamps() const noexcept { return trusted_; }

private:
  /// A record and how it follows the one before.
  struct Step {
    std::uint32_t gap;
    bool was_late; ///< the record before was sampled off its period, as the glove says
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
  std::uint32_t longest_gap() const noexcept;

  // The clock.
  std::uint32_t period_;
  bool steady_;         ///< the period is kept closely, but for late records
  bool trusted_ = true; ///< the stamps make sense
  bool begun_ = false;
  std::uint32_t last_ticks_ = 0;
  bool last_late_ = false;
  StampJitter jitter_;
  std::uint32_t late_pace_ = 0;         ///< between late records, 0 while unknown
  std::array<std::uint32_t, 8> gaps_{}; ///< the first ones, while a period is learnt
  std::size_t gap_count_ = 0;
  std::uint64_t learnt_missed_ = 0; ///< in these gaps, and counted
  int doubt_ = 0;                   ///< rises with refusals, falls with acceptances
  std::uint64_t refused_ = 0;       ///< since the last accepted record
  Suspects suspects_;

  // The status byte.
  bool status_known_ = false;
  std::uint8_t status_constant_ = 0;
  std::uint8_t status_suspect_ = 0;
  int status_suspects_ = 0;
};

} // namespace nendo::driver::cyberglove
