#pragma once
// A viewer beside a loop, like `nendo view` without the window. It polls frames and makes scenes of
// them on a thread of its own.

#include <atomic>
#include <chrono>
#include <thread>

#include "render/scene.hpp"
#include "support/flow_fixtures.hpp"

namespace nendo::test {

class PollingViewer {
public:
  /// Starts to poll a thousand times a second, as the frames' only reader. Returns when it has made
  /// a scene.
  explicit PollingViewer(LoopUnderTest& test) : thread_([this, &test] { look_on(test); }) {
    while (scenes_ == 0)
      std::this_thread::yield();
  }
  ~PollingViewer() { end(); }
  PollingViewer(const PollingViewer&) = delete;
  PollingViewer& operator=(const PollingViewer&) = delete;

  /// Ends the viewer and returns how many scenes it made.
  std::uint64_t end() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    return scenes_;
  }

private:
  void look_on(LoopUnderTest& test) {
    const render::SceneBuilder builder(test.model, test.placement.units_per_metre);
    render::HoldTracker holds;
    render::SceneFrame scene_frame;
    render::Scene scene;
    for (auto next = HostClock::now(); !over_;) {
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
      if (!test.loop->frames().update() && scenes_ > 0) continue;
      const flow::Frame& frame = test.loop->frames().front();
      holds.follow(frame);
      render::set_hands(frame, holds, scene_frame);
      test.loop->changes().layout().unpack(frame.shape, scene_frame.vertices);
      builder.build(scene_frame, {}, scene);
      ++scenes_;
    }
  }

  std::atomic<bool> over_{false};
  std::atomic<std::uint64_t> scenes_{0};
  std::thread thread_;
};

} // namespace nendo::test
