#pragma once
// Ticks of a loop that is asked for changes of all kinds at random, whose allocations and locks are
// counted.

#include <optional>
#include <random>

#include "support/flow_fixtures.hpp"
#include "support/late_maker.hpp"
#include "support/restraint.hpp"

namespace nendo::test {

/// Adds to `sum` what the ticks did that they must not. The loop's log is `log`. next_rig(now,
/// random): the puppet, or the masks, that the loop shall continue with; null: none. With a mode,
/// it stays in that one.
template <class NextRig>
void tick_with_changes(LoopUnderTest& test, flow::InputLog& log, std::uint64_t ticks, unsigned seed,
                       const NextRig& next_rig, RestraintCounts& sum,
                       std::optional<flow::Mode> mode = {}) {
  std::mt19937 random(seed);
  LateMaker maker(seed, 1000);
  HostTime now = HostClock::now();
  flow::DeformLoop& loop = *test.loop;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (random() % 12 == 0)
      if (const auto rig = next_rig(loop.changes().puppet(loop.changes().newest_puppet()), random))
        static_cast<void>(loop.changes().change_puppet(rig));
    if (random() % 30 == 0) {
      flow::LoopSettings settings = any_settings(loop.changes().settings(), random);
      settings.mode = mode.value_or(settings.mode);
      static_cast<void>(loop.changes().change_settings(settings));
    }
    maker.turn(loop);
    if (random() % 200 == 0 && maker.is_idle(loop))
      loop.changes().change_log(random() % 2 == 0 ? &log : nullptr, loop.frames().front().shape);
    if (random() % 8 == 0) test.commands.try_push(flow::requests[random() % flow::requests.size()]);
    test.bend(static_cast<int>(tick % 40), now += std::chrono::milliseconds(1));
    {
      const Restraint restraint;
      loop.tick(tick, now, now);
      sum.allocations += restraint.counts().allocations;
      sum.frees += restraint.counts().frees;
      sum.locks += restraint.counts().locks;
    }
    if (random() % 2 == 0 && loop.frames().update())
      if (const auto& awaited = loop.frames().front().awaited)
        static_cast<void>(loop.changes().change_to(*awaited));
    log.drain([](const auto&) noexcept {});
    loop.changes().take_state();
    loop.changes().refill_undo();
  }
}

} // namespace nendo::test
