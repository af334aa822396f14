#pragma once
// Loops with layers over a virtual clock: what hands do is a function of the tick alone.

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "support/flow_fixtures.hpp"

namespace nendo::test {

/// A performance: how far a hand is bent at a tick, in counts.
using Performance = std::function<int(std::uint64_t tick)>;

/// Returns a smooth performance that differs for each seed.
inline Performance performance(unsigned seed) {
  return [seed](std::uint64_t tick) {
    const double time = 0.02 * static_cast<double>(tick) * (1.0 + 0.3 * seed);
    return static_cast<int>(
        std::lround(14.0 + 14.0 * std::sin(time + seed) * std::cos(0.3 * time)));
  };
}

/// One loop whose live inputs the test plays.
class LayeredLoop {
public:
  static constexpr double rate_hz = 100.0;

  /// `inputs` are as for a loop; those without a ring are the script's.
  LayeredLoop(const LoopUnderTest& like, std::vector<flow::HandInput> inputs,
              flow::InputScript* script = nullptr)
      : options(like.options) {
    options.rate_hz = rate_hz;
    options.script = script;
    options.input_log = &log;
    options.commands = &commands;
    loop =
        std::make_unique<flow::DeformLoop>(like.model, like.placement, std::move(inputs), options);
  }

  /// Runs a tick of the grid that begins at `begin`, and returns its frame.
  const flow::Frame& tick(std::uint64_t number, HostTime begin) {
    const HostTime due = flow::TickGrid(begin, rate_hz).deadline(number);
    loop->tick(number, due, due);
    loop->frames().update();
    return loop->frames().front();
  }

  /// Makes a script of all that the loop has taken.
  std::unique_ptr<flow::InputScript> script_so_far() {
    std::vector<flow::InputScript::Event> events;
    std::size_t timed = 0;
    HostTime first{};
    HostClock::duration length{};
    bool has_tick = false;
    log.drain([&](const flow::InputLogEntry& entry) noexcept {
      const auto* tick = std::get_if<flow::LoggedTick>(&entry);
      if (tick == nullptr) return events.push_back({{}, entry});
      if (!std::exchange(has_tick, true)) first = tick->scheduled;
      length = tick->scheduled - first;
      for (; timed < events.size(); ++timed)
        events[timed].at = length;
    });
    return std::make_unique<flow::InputScript>(std::move(events), first, length);
  }

  flow::LoopOptions options;
  flow::InputLog log;
  flow::CommandRing commands{64};
  std::unique_ptr<flow::DeformLoop> loop;
};

/// An input that a script plays.
inline flow::HandInput scripted(flow::HandInput input) {
  input.ring = nullptr;
  return input;
}

inline flow::HandInput layer_of(flow::HandInput input, flow::AngleSet joints, bool on = true) {
  input.layer.emplace().joints = joints;
  input.layer->on = on;
  input.layer->weight = on ? 1.0 : 0.0;
  return input;
}

inline bool same_angles(const hand::JointAngles& one, const hand::JointAngles& other) {
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (one[hand::angle_at(at)] != other[hand::angle_at(at)]) return false;
  return true;
}

} // namespace nendo::test
