#include <nendo/flow/input_script.hpp>

#include <algorithm>
#include <cmath>

#include <nendo/flow/hand_input.hpp>

namespace nendo::flow {
namespace {

using std::chrono::nanoseconds;

template <class Sample>
void move_times(Sample& sample, HostClock::duration by) noexcept {
  sample.arrival += by;
  sample.measured += by;
}

/// Goes from the counts of `from` to those of `to`, which are of the same glove.
void depart(const GloveSample& from, GloveSample& to, double part) noexcept {
  const double weight = part * part * (3.0 - 2.0 * part);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!from.present.has(sensor) || !to.present.has(sensor)) continue;
    const double before = from.raw[slot].value;
    const double count = before + weight * (to.raw[slot].value - before);
    to.raw[slot].value = static_cast<std::uint16_t>(std::lround(count));
  }
}

} // namespace

void InputScript::add(HostClock::duration at, const Command& command) {
  const auto place = std::lower_bound(
      events_.begin(), events_.end(), at,
      [](const Event& event, HostClock::duration time) { return event.at < time; });
  events_.insert(place, {at, command});
}

GloveSample InputScript::moved(GloveSample sample) const noexcept {
  move_times(sample, shift_);
  return sample;
}

TakenSample InputScript::now_played(TakenSample taken, HostClock::duration at) noexcept {
  Stream& stream = streams_[taken.hand % max_inputs];
  GloveSample& sample = taken.sample;
  const std::uint64_t recorded = sample.sequence;
  move_times(sample, shift_ + offset_);
  sample.device_time += std::chrono::duration_cast<nanoseconds>(offset_);
  if (stream.departs && round_) {
    const double part = to_seconds(at - round_->from) / to_seconds(Layer::blend_time);
    stream.departs = part < 1.0;
    if (stream.departs) depart(stream.held, sample, std::max(part, 0.0));
    // What came before the round ended must not seem to come after it.
    sample.arrival = std::max(sample.arrival, stream.last.arrival);
    sample.measured = std::max(sample.measured, stream.last.measured);
  }
  // Numbers that are missing in the recording are missing here; a new round is no gap.
  if (stream.begun)
    sample.sequence =
        stream.last.sequence + (recorded > stream.recorded ? recorded - stream.recorded : 1);
  stream.recorded = recorded;
  stream.begun = true;
  stream.last = sample;
  return taken;
}

/// At the beginning of a round the hand may jump, as after a loss: its gate and filter see to that.
TakenPose InputScript::now_played(TakenPose taken) const noexcept {
  move_times(taken.pose, shift_ + offset_);
  taken.pose.device_time += std::chrono::duration_cast<nanoseconds>(offset_);
  return taken;
}

void InputScript::begin_again() noexcept {
  offset_ += round_->to - round_->from;
  const auto place = std::lower_bound(
      events_.begin(), events_.end(), round_->from,
      [](const Event& event, HostClock::duration time) { return event.at < time; });
  next_ = static_cast<std::size_t>(place - events_.begin());
  for (Stream& stream : streams_) {
    stream.held = stream.last;
    stream.departs = stream.begun;
  }
}

} // namespace nendo::flow
