#include "gloves/stuck_sensors.hpp"

#include <chrono>
#include <thread>

#include <nendo/hand/stuck_watch.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {
std::vector<std::string> StuckNotices::changes(SensorMask left_out, const GloveSample* sample) {
  const SensorMask before = known_.value_or(left_out);
  known_ = left_out;
  std::vector<std::string> sentences;
  for (const Sensor sensor : SensorMask{left_out.bits & ~before.bits}) {
    const std::string place =
        sample != nullptr ? " at " + std::to_string((*sample)[sensor].value) : std::string();
    sentences.push_back(std::string(name_of(sensor)) + " stands still" + place +
                        " while the hand moves: it is left out, and estimated from the sensors "
                        "beside");
  }
  for (const Sensor sensor : SensorMask{before.bits & ~left_out.bits})
    sentences.push_back(std::string(name_of(sensor)) + " moves again: it is measured");
  return sentences;
}

std::vector<SensorAtEnd> sensors_at_end(driver::Glove& glove) {
  const driver::GloveInfo& info = glove.info();
  if (info.kind != driver::SourceKind::device || info.counts.self_calibrated) return {};
  constexpr auto patience = std::chrono::milliseconds(2000);
  constexpr auto looks = std::chrono::milliseconds(500);
  SampleRing ring(1024);
  if (!glove.start(ring)) return {};
  SensorMask at_end = info.sensors;
  std::optional<GloveSample> last;
  const HostTime begun = HostClock::now();
  std::optional<HostTime> first;
  while (HostClock::now() < begun + patience && !cli::stop_requested() &&
         (!first || HostClock::now() < *first + looks)) {
    GloveSample sample;
    if (!ring.try_pop(sample)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      continue;
    }
    if (!first) first = HostClock::now();
    last = sample;
    for (const Sensor sensor : at_end)
      if (!sample.present.has(sensor) || !hand::is_at_end(sample[sensor].value, info.counts))
        at_end.bits &= ~(1U << static_cast<unsigned>(sensor));
  }
  glove.stop();
  std::vector<SensorAtEnd> found;
  if (!last) return found;
  for (const Sensor sensor : at_end)
    found.push_back({sensor, (*last)[sensor].value});
  return found;
}

std::string in_words(const SensorAtEnd& found) {
  return std::string(name_of(found.sensor)) + " is at the end of its range (" +
         std::to_string(found.count) +
         "): if it stays there whatever the hand does, the sensor or its wire is broken";
}

} // namespace nendo::gloves
