// The part of the loop that counts what came in, and how long it took.

#include <nendo/flow/deform_loop.hpp>

#include <utility>

namespace nendo::flow {

void DeformLoop::count(Hand& hand, std::size_t samples, HostTime now) noexcept {
  const bool silent = now - hand.latest.arrival > options_.silent_after;
  const bool fell_silent = silent && !std::exchange(hand.silent, silent);
  hand.silent = silent;
  if (!hand.is_topmost) return;
  if (fell_silent) ++stats_.silences[hand.slot];
  stats_.samples[hand.slot] += samples;
  SampleRate& rate = stats_.rates[hand.slot];
  if (stats_.ticks == 0) {
    rate = {0, hand.latest.arrival, hand.latest.arrival};
  } else if (hand.fresh) {
    rate.samples += samples;
    rate.last = hand.latest.arrival;
  }
  stats_.spikes[hand.slot] = hand.gate.spikes();
  stats_.left_out[hand.slot] = hand.left_out();
  stats_.was_left_out[hand.slot].bits |= hand.left_out().bits;
  if (const auto* learned = hand.calibration.adaptation()) {
    stats_.ranges[hand.slot] = learned->ranges();
    stats_.range_sides[hand.slot] = learned->side().value_or(hand.input.side);
  } else if (const auto* slips = hand.calibration.slips()) {
    stats_.ranges[hand.slot] = slips->ranges();
    stats_.range_sides[hand.slot] = slips->side();
    stats_.slips_counts[hand.slot] = slips->slips_counts();
  }
}

void DeformLoop::record_latencies(const TickRecord& record) noexcept {
  const HostTime done = record.published();
  stats_.wake_latency.record(record.woke - record.scheduled);
  stats_.work.record(done - record.woke);
  for (const auto& hand : hands_) {
    if (!hand.fresh) continue;
    stats_.end_to_end.record(done - hand.latest.arrival);
    if (hand.filter.options().kind == hand::FilterKind::off) continue;
    const hand::FilterLatency latency = hand.filter.latency();
    stats_.filter_moving.record(from_seconds(latency.moving_s));
    stats_.filter_worst.record(from_seconds(latency.worst_s));
  }
}

} // namespace nendo::flow
