#pragma once
// An application with the layer, over the mock runtime, and a segment that the test writes.

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "openxr/application.hpp"
#include "support/eventually.hpp"

namespace nendo::test {

inline constexpr XrPosef usual_stage{{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, -0.4F, -0.6F}};

inline Eigen::Isometry3d matrix_of(const XrPosef& pose) {
  const auto& q = pose.orientation;
  const auto& p = pose.position;
  return Eigen::Translation3d(Eigen::Vector3f(p.x, p.y, p.z).cast<double>()) *
         Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>().normalized();
}
inline Eigen::Isometry3d matrix_of(const WrittenJoint& joint) {
  return matrix_of(
      XrPosef{{joint[3], joint[4], joint[5], joint[6]}, {joint[0], joint[1], joint[2]}});
}

/// The farthest distances, in metres and radians, of located joints from those expected.
struct Distance {
  double position = 0.0;
  double turn = 0.0;
};
inline Distance distance(const LocatedHand& located, const WrittenHand& written,
                         const Eigen::Isometry3d& stage_in_base) {
  Distance max;
  for (std::size_t k = 0; k < 26; ++k) {
    const Eigen::Isometry3d is = matrix_of(located.joints[k].pose);
    const Eigen::Isometry3d should = stage_in_base * matrix_of(written.joints[k]);
    max.position = std::max(max.position, (is.translation() - should.translation()).norm());
    max.turn = std::max(max.turn, (is.linear() - should.linear()).norm());
  }
  return max;
}

/// Spaces that are at different places in the world, and move.
inline void let_move(MockRuntime& runtime) {
  runtime.local.place = {{0.0F, 0.6F, 0.0F, 0.8F}, {0.5F, 1.2F, -0.3F}};
  runtime.view.place = {{0.1F, 0.1F, 0.1F, 0.98488579F}, {0.4F, 1.6F, 0.2F}};
  runtime.view.radius_m = 0.1;
  runtime.view.turns_per_s = 0.5;
  runtime.stage.place = {{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.1F}};
  runtime.action.place = {{0.0F, 0.0F, 0.70710678F, 0.70710678F}, {0.3F, 1.0F, -0.2F}};
  runtime.action.radius_m = 0.3;
  runtime.action.turns_per_s = -1.0;
}

inline const std::array<XrHandEXT, 2> both_hands{XR_HAND_LEFT_EXT, XR_HAND_RIGHT_EXT};

/// A session with the focus, by the loader, with a segment that has two hands at rest.
struct Opened {
  explicit Opened(const std::string& what,
                  const std::vector<const char*>& extensions = usual_extensions())
      : name(WrittenSegment::unique_name(what)), environment(name),
        segment(std::make_unique<WrittenSegment>(name)),
        hands{sample_hand(-0.2F), sample_hand(0.1F)} {
    write_still();
    instance = std::make_unique<OpenInstance>(XR_NULL_HANDLE, xrGetInstanceProcAddr);
    const InstanceInfo info(extensions);
    REQUIRE(xrCreateInstance(info.get(), &instance->handle) == XR_SUCCESS);
    session = std::make_unique<OpenSession>(*instance);
  }
  ~Opened() {
    session.reset();
    instance.reset();
  }

  /// Records of some ticks, in which nothing moves.
  void write_still() {
    const std::int64_t now = monotonic_ns();
    for (int tick = 4; tick >= 0; --tick)
      (*segment)->write(hands, now - tick * 11'111'111);
  }
  XrTime now() const { return monotonic_ns() + runtime->clock_offset_ns; }
  /// Locates the right hand in LOCAL, now.
  LocatedHand locate(XrHandTrackerEXT tracker) const {
    return session->locate(tracker, session->spaces[1], now());
  }
  /// Waits until the layer has looked for the segment again.
  template <class Condition>
  bool polled_until(Condition&& condition) const {
    return eventually([&] {
      session->poll();
      return condition();
    });
  }

  MockRuntime* runtime = &fresh_runtime();
  std::string name;
  LoaderEnvironment environment;
  std::unique_ptr<WrittenSegment> segment;
  std::array<WrittenHand, 2> hands;
  std::unique_ptr<OpenInstance> instance;
  std::unique_ptr<OpenSession> session;
};

} // namespace nendo::test
