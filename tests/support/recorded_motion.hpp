#pragma once
// A recording of hands that bend evenly, and its frames as they were when it was made.

#include <cmath>
#include <memory>
#include <vector>

#include "support/takes.hpp"
#include "takes/recorded_frames.hpp"

namespace nendo::test {

struct Motion {
  flow::Mode mode = flow::Mode::type1;
  bool injective = false;
  std::uint64_t ticks = 60;
  double bend_counts = 25.0;          ///< there and back once
  std::uint64_t commit_at_tick = ~0U; ///< never
  std::uint64_t subdivide_at_tick = ~0U;
  int hertz = 100;
  const char* puppet = nullptr; ///< or masks: the text of its file
};

/// A recording with a tick every 1/hertz s. The first tick is that long after the beginning.
struct RecordedMotion {
  explicit RecordedMotion(const Motion& motion)
      : played(motion.mode, hand::FilterKind::off, false, motion.injective,
               flow::SwitchAction::none, motion.puppet) {
    played.setup.loop->options.rate_hz = motion.hertz;
    played.record();
    for (std::uint64_t tick = 0; tick < motion.ticks; ++tick) {
      const HostTime woke = played.setup.begun_host + (tick + 1) *
                                                          std::chrono::nanoseconds(std::nano::den) /
                                                          static_cast<std::uint64_t>(motion.hertz);
      const double turn =
          6.283185307179586 * static_cast<double>(tick) / static_cast<double>(motion.ticks - 1);
      played.test.bend(static_cast<int>(motion.bend_counts * 0.5 * (1.0 - std::cos(turn))), woke);
      if (tick == motion.commit_at_tick) played.test.commands.try_push(flow::Request::commit);
      flow::DeformLoop& loop = *played.test.loop;
      if (tick == motion.subdivide_at_tick) REQUIRE(loop.changes().hold_still());
      if (loop.changes().is_still()) {
        flow::PendingModel finer(loop.changes().newest_model());
        REQUIRE(loop.changes().change_model(finer));
      }
      loop.tick(tick, woke, woke);
      played.test.loop->frames().update();
      const flow::Frame& frame = played.test.loop->frames().front();
      times_s.push_back(seconds_between(played.setup.begun_host, woke));
      shapes.push_back(played.test.vertices_of(frame));
      hands.push_back({frame.hands[0].pose, frame.hands[1].pose});
    }
    if (!played.end()) throw std::runtime_error("not recorded");
  }

  std::unique_ptr<takes::FrameSource> frames() const {
    auto opened = takes::RecordedFrames::open(played.path, played.test.model);
    if (!opened) throw std::runtime_error(opened.error().message);
    return *std::move(opened);
  }
  std::filesystem::path path(const std::string& name) const { return played.folder.path() / name; }
  double diagonal() const { return deform::diagonal_of(played.test.model.vertices); }

  RecordedLoop played;
  std::vector<double> times_s;
  std::vector<deform::Points> shapes;
  std::vector<std::array<hand::HandPose, 2>> hands;
};

inline double farthest(const deform::Points& a, const deform::Points& b) {
  return (a - b).colwise().norm().maxCoeff();
}

} // namespace nendo::test
