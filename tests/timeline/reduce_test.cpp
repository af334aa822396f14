#include <doctest/doctest.h>

#include "support/timelines.hpp"
#include "timeline/hand_curve.hpp"
#include "timeline/reduce.hpp"

namespace reduce_test {

using namespace nendo;
using namespace nendo::timeline;

namespace {

/// Of all frames, by the skeleton alone.
Deviation farthest(const hand::HandSkeleton& skeleton, const std::vector<Key>& frames,
                   const std::vector<Key>& keys) {
  const HandCurve curve(keys);
  Deviation worst;
  for (const Key& frame : frames) {
    const Key made = curve.at(frame.time_s);
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      worst.angle_rad = std::max(worst.angle_rad, std::abs(made.angles[hand::angle_at(at)] -
                                                           frame.angles[hand::angle_at(at)]));
    const auto wanted = skeleton.pose(frame.angles, frame.wrist_pose());
    const auto reached = skeleton.pose(made.angles, made.wrist_pose());
    for (const hand::Joint tip : hand::fingertips)
      worst.tip_m =
          std::max(worst.tip_m, (wanted[tip].translation() - reached[tip].translation()).norm());
  }
  return worst;
}

} // namespace

TEST_SUITE("reduce") {
  TEST_CASE("no frame is farther off than the tolerance, and the report does not say less") {
    const auto frames = test::waving(900);
    const hand::HandSkeleton skeleton(Side::left);
    std::size_t keys_before = frames.size() + 1;
    for (const double tip_m : {1e-5, 1e-4, 1e-3, 1e-2}) {
      CAPTURE(tip_m);
      const Reduction reduction = reduce_keys(skeleton, frames, {.tip_m = tip_m});
      const Deviation worst = farthest(skeleton, frames, reduction.keys);
      CHECK(worst.tip_m <= tip_m);
      CHECK(reduction.worst.tip_m <= tip_m);
      CHECK(reduction.worst.tip_m >= worst.tip_m);
      CHECK(reduction.worst.angle_rad >= worst.angle_rad);
      CHECK(reduction.frames == frames.size());
      CHECK(reduction.keys.size() < keys_before);
      keys_before = reduction.keys.size();
    }
    CHECK(keys_before < 90);
    for (const double angle_rad : {1e-4, 1e-2}) {
      const Reduction reduction = reduce_keys(skeleton, frames, {.angle_rad = angle_rad});
      CHECK(farthest(skeleton, frames, reduction.keys).angle_rad <= angle_rad);
      CHECK(reduction.keys.size() < frames.size());
    }
  }

  TEST_CASE("keys are frames, in their order, with the first and the last among them") {
    const auto frames = test::waving(300);
    const Reduction reduction =
        reduce_keys(hand::HandSkeleton(Side::right), frames, {.tip_m = 1e-3});
    CHECK(same_bits(reduction.keys.front(), frames.front()));
    CHECK(same_bits(reduction.keys.back(), frames.back()));
    std::size_t frame = 0;
    for (const Key& key : reduction.keys) {
      while (frame < frames.size() && !same_bits(frames[frame], key))
        ++frame;
      CHECK(frame < frames.size());
    }
  }

  TEST_CASE("a tolerance of nothing gives every frame back") {
    const auto frames = test::waving(200);
    const hand::HandSkeleton skeleton(Side::right);
    const Reduction reduction = reduce_keys(skeleton, frames, {.angle_rad = 0.0, .tip_m = 0.0});
    const Deviation worst = farthest(skeleton, frames, reduction.keys);
    CHECK(worst.angle_rad == 0.0);
    CHECK(worst.tip_m == 0.0);
  }

  TEST_CASE("a hand that rests needs two keys, one frame one, and nothing none") {
    auto frames = test::waving(100);
    for (Key& frame : frames) {
      const double time_s = frame.time_s;
      frame = frames.front();
      frame.time_s = time_s;
    }
    const hand::HandSkeleton skeleton(Side::left);
    CHECK(reduce_keys(skeleton, frames, {.tip_m = 1e-9}).keys.size() == 2);
    CHECK(reduce_keys(skeleton, std::span(frames).first(1), {.tip_m = 1e-9}).keys.size() == 1);
    CHECK(reduce_keys(skeleton, {}, {}).keys.empty());
  }
}

} // namespace reduce_test
