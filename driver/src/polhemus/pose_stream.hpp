#pragma once
// The stream of a FASTRAK or an ISOTRAK II, which differ in their records and in the dialogue
// before.

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/spdlog.h>

#include "polhemus/polhemus_greeting.hpp"
#include "polhemus/polhemus_options.hpp"
#include "polhemus/pose_record.hpp"
#include "stream/line_times.hpp"
#include "stream/tracker_protocol.hpp"

namespace nendo::driver::polhemus {

/// What a tracker measures and sends.
struct StreamFacts {
  std::size_t record_bytes = 0;
  double records_per_second = 0.0; ///< all stations together; 0 if unknown
  /// From the middle of a measurement to the solution's being ready.
  std::chrono::microseconds solution_delay{0};
};

/// A driver adds identify(), which sets baud_ and source_. Records of `Parser` are PoseRecords.
template <class Parser>
class PoseStream : public TrackerProtocol {
public:
  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& limit) override {
    TextDialogue dialogue(transport, limit);
    dialogue.send(binary_command);
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    times_ = LineTimes(baud_, facts_.record_bytes, facts_.records_per_second);
    dialogue.send(stream_command);
    return dialogue.is_gone() ? Result<void>(went_away(source)) : Result<void>();
  }

  void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept override {
    constexpr std::chrono::milliseconds quiet{50};
    constexpr std::chrono::milliseconds max_stop{250};
    TextDialogue dialogue(transport, limit);
    dialogue.send(stop_command);
    dialogue.fall_quiet(quiet, max_stop);
    dialogue.send(text_command);
    parser_.count_discarded(dialogue.bytes_received());
  }

  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const std::uint64_t end = parser_.counters().bytes + chunk.size();
    const auto take = [&](const PoseRecord& record) {
      note_error(record);
      PoseSample sample;
      sample.station = record.station;
      sample.position_m = record.position_m;
      sample.turn_xyzw = record.turn_xyzw;
      sample.error = record.error;
      const HostTime begin = times_.record_begin(arrival, end - parser_.counters().bytes);
      sample.measured = times_.in_order(begin - facts_.solution_delay);
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

protected:
  /// `first_baud` is tried first, if the options name none.
  PoseStream(Options options, int first_baud, const StreamFacts& facts)
      : options_(std::move(options)), baud_(options_.baud.value_or(first_baud)), facts_(facts) {
    errors_.fill(' ');
  }

  /// Returns what an error letter means.
  virtual std::string_view meaning_of(char letter) const noexcept = 0;

  const Options options_;
  std::string source_; ///< begins the messages
  int baud_;           ///< the one that was answered, or the first to try
  StreamFacts facts_;
  Parser parser_;

private:
  /// Each letter of a station once: it stays in all records after.
  void note_error(const PoseRecord& record) noexcept {
    if (record.error == std::exchange(errors_[record.station], record.error)) return;
    if (record.error == ' ') return;
    spdlog::warn("device: {}: station {} reports the error {}: {}", source_, record.station,
                 record.error, meaning_of(record.error));
  }

  LineTimes times_;
  std::array<char, max_station + 1> errors_; ///< the last letter of each station
};

} // namespace nendo::driver::polhemus
