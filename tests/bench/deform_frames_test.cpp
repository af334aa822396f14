#include "bench/deform_frames.hpp"

#include <chrono>

#include <doctest/doctest.h>

#include "reference/table1.hpp"

namespace deform_frames_test {

using namespace nendo::bench;
using namespace nendo::reference;
using namespace std::chrono_literals;

TEST_SUITE("deform_frames") {
  /// Stands still but for the frames.
  struct FrameClock {
    static std::chrono::steady_clock::time_point now() { return now_; }
    static inline std::chrono::steady_clock::time_point now_{};
  };

  TEST_CASE("the best time is the least that a few frames in a row take, of all turns") {
    BestBy<FrameClock> best;
    CHECK(best.us() == 0.0);
    const auto turn = [&](std::size_t vertices, std::chrono::microseconds first, auto later) {
      std::size_t frames = 0;
      best.measure(vertices, [&](std::size_t n) {
        CHECK(n == frames++);
        FrameClock::now_ += n == 0 ? first : later;
      });
      return frames;
    };
    // Two at a time, eight at least; the first one has to wait for memory.
    CHECK(turn(1'000'000, 900us, 300us) == 8);
    CHECK(best.us() == 300.0);
    CHECK(turn(1'000'000, 100us, 400us) == 8);
    CHECK(best.us() == 250.0);
    // Three at a time, for a millisecond; 64 at a time, until there are a hundred.
    CHECK(turn(33'025, 40us, 40us) == 27);
    CHECK(best.us() == 40.0);
    CHECK(turn(1089, 2us, 2us) == 128);
    CHECK(best.us() == 2.0);
    CHECK(best.per_second() == 500'000.0);
  }

  TEST_CASE("each turn of strokes begins with the mesh as it was, and is like the first") {
    const nendo::deform::Points mesh = table1_plane(64);
    for (const int threads : {1, 2}) {
      Strokes strokes(mesh, table1_starts(), 20.0, threads);
      const auto shape = [&] {
        nendo::deform::Points out;
        strokes.deformer().layout().unpack(strokes.deformer().shape(), out);
        return out;
      };
      nendo::deform::Points first_end;
      for (int turn = 0; turn < 3; ++turn) {
        strokes.begin();
        CHECK(shape() == mesh);
        for (std::size_t n = 0; n < 50; ++n) {
          const nendo::deform::Points before = shape();
          strokes.stroke(n);
          CHECK(shape() != before); // none is free
        }
        if (turn == 0) first_end = shape();
        CHECK(shape() == first_end);
      }
    }
  }
}

} // namespace deform_frames_test
