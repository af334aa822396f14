#include <nendo/hand/range_capture.hpp>

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

namespace range_capture_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

constexpr auto slot = static_cast<std::size_t>(Sensor::ring_pip);

GloveSample sample_of(std::uint16_t counts) {
  GloveSample sample;
  sample.set(Sensor::ring_pip, RawCount{counts});
  return sample;
}

} // namespace

TEST_SUITE("range_capture") {
  TEST_CASE("a steady motion's ends are what it reached and stayed at") {
    RangeCapture capture;
    CHECK(capture.seen().present.bits == 0);
    for (std::uint16_t counts = 60; counts <= 180; ++counts)
      capture.push(sample_of(counts));
    for (std::uint16_t counts = 180; counts >= 40; --counts)
      capture.push(sample_of(counts));
    capture.push(sample_of(40));
    CHECK(capture.seen().low_counts[slot] == 40.0);
    CHECK(capture.seen().high_counts[slot] == 180.0);
    CHECK(capture.seen().present.bits == 1U << slot);
  }

  TEST_CASE("single samples that jump widen no range, wherever they are") {
    std::mt19937 random(1);
    RangeCapture capture;
    for (int n = 0; n < 5000; ++n) {
      const bool jumps = n % 3 == 1 && random() % 4 == 0;
      capture.push(sample_of(static_cast<std::uint16_t>(jumps        ? random() % 256
                                                        : n % 2 == 0 ? 100U
                                                                     : 101U)));
    }
    CHECK(capture.seen().low_counts[slot] >= 100.0);
    CHECK(capture.seen().high_counts[slot] <= 101.0);
  }

  TEST_CASE("a capture that continues an earlier one keeps its ends, and widens them") {
    RangeCapture before;
    for (const int counts : {60, 60, 60, 180, 180})
      before.push(sample_of(static_cast<std::uint16_t>(counts)));
    RangeCapture after(before.seen());
    CHECK(after.seen().present.bits == 1U << slot);
    for (const int counts : {100, 100, 100, 40, 40})
      after.push(sample_of(static_cast<std::uint16_t>(counts)));
    CHECK(after.seen().low_counts[slot] == 40.0);
    CHECK(after.seen().high_counts[slot] == 180.0);
  }

  TEST_CASE("what is missing for a while is not compared across the gap") {
    RangeCapture capture;
    capture.push(sample_of(100));
    capture.push(GloveSample{});
    capture.push(sample_of(200));
    capture.push(sample_of(200));
    CHECK(capture.seen().present.bits == 0);
    capture.push(sample_of(200));
    CHECK(capture.seen().low_counts[slot] == 200.0);
  }
}

} // namespace range_capture_test
