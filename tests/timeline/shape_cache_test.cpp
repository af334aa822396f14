#include <cmath>
#include <cstring>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"
#include "support/timelines.hpp"
#include "timeline/edit.hpp"
#include "timeline/shape_cache.hpp"

namespace shape_cache_test {

using namespace nendo;
using namespace nendo::timeline;
using deform::BlockShape;

namespace {

const deform::Mesh& model() {
  static const deform::Mesh ball = test::sphere(16, 32, 1.0);
  return ball;
}

bool same_bits(const BlockShape& one, const BlockShape& other) {
  return one.block_count() == other.block_count() &&
         std::memcmp(one.data(), other.data(), one.block_count() * sizeof(deform::VertexBlock)) ==
             0;
}

struct Frames {
  std::vector<BlockShape> shapes;
  std::vector<bool> held;
  std::vector<double> held_since_s;
};

/// As `nendo edit play` makes them, one after another.
Frames played(const Timeline& timeline) {
  auto player = Player::make(timeline, model());
  REQUIRE(player);
  Frames frames;
  bool held = false;
  std::uint64_t kept = 0;
  double since_s = 0.0;
  while ((*player)->next()) {
    const flow::Frame& frame = (*player)->frame();
    const std::uint64_t steps = frame.rest_changes + 1000 * frame.shape_jumps;
    if (frame.held && (!held || steps != kept)) since_s = (*player)->time_s();
    held = frame.held;
    kept = steps;
    frames.shapes.push_back(frame.shape);
    frames.held.push_back(held);
    frames.held_since_s.push_back(since_s);
  }
  return frames;
}

void check_all(const ShapeCache& cache, const Timeline& timeline) {
  const Frames frames = played(timeline);
  const auto progress = cache.progress();
  CHECK(progress.done);
  CHECK_FALSE(progress.error);
  CHECK(std::abs(progress.until_s - timeline.duration_s) < 1.0 / timeline.rate_hz);
  const std::size_t last = frames.shapes.size() - 1;
  for (std::size_t at = 0; at <= last; ++at) {
    const auto found = cache.nearest(static_cast<double>(at) / timeline.rate_hz);
    REQUIRE(found.shape);
    CHECK(found.fresh);
    const std::size_t frame = found.shape->frame;
    REQUIRE(frame <= last);
    CHECK((frame % progress.stride == 0 || frame == last));
    const std::size_t off = frame > at ? frame - at : at - frame;
    CHECK(2 * off <= progress.stride);
    CHECK(same_bits(found.shape->shape, frames.shapes[frame]));
    CHECK(found.shape->held == frames.held[frame]);
    if (found.shape->held) CHECK(found.shape->held_since_s == frames.held_since_s[frame]);
  }
}

std::size_t bytes_of_one() {
  return deform::BlockLayout(model().vertices).block_count() * (sizeof(deform::VertexBlock) + 8);
}

} // namespace

TEST_SUITE("shape_cache") {
  TEST_CASE("its shapes are the player's, bit for bit, in both modes, across what was asked for") {
    for (const flow::Mode mode : {flow::Mode::type1, flow::Mode::type2}) {
      const Timeline timeline = test::waved_timeline(model(), mode);
      ShapeCache cache(model());
      CHECK_FALSE(cache.nearest(0.0).shape);
      cache.follow(timeline);
      cache.wait();
      CHECK(cache.progress().stride == 1);
      check_all(cache, timeline);
      CHECK_FALSE(same_bits(cache.nearest(0.0).shape->shape,
                            cache.nearest(timeline.duration_s).shape->shape));
    }
  }

  TEST_CASE("with little memory it keeps every k-th and the last, and no more than it may") {
    const Timeline timeline = test::waved_timeline(model(), flow::Mode::type1);
    for (const std::size_t shapes : {0U, 2U, 5U, 31U, 60U, 89U, 90U}) {
      CAPTURE(shapes);
      const std::size_t max_bytes = shapes * (bytes_of_one() + 256);
      ShapeCache cache(model(), max_bytes);
      cache.follow(timeline);
      cache.wait();
      const auto progress = cache.progress();
      CHECK(progress.shapes * bytes_of_one() <= std::max(max_bytes, 2 * bytes_of_one()));
      CHECK(progress.shapes >= 2);
      check_all(cache, timeline);
    }
  }

  TEST_CASE("edits while it works leave nothing of earlier timelines behind") {
    for (const flow::Mode mode : {flow::Mode::type1, flow::Mode::type2}) {
      Timeline timeline = test::waved_timeline(model(), mode);
      ShapeCache cache(model());
      std::mt19937 random(1);
      for (int edit = 0; edit < 40; ++edit) {
        const Side side = random() % 2 == 0 ? Side::left : Side::right;
        const std::size_t key = random() % 8;
        const double to_s = 1e-3 * static_cast<double>(random() % 980);
        switch (random() % 6) {
        case 0:
          static_cast<void>(delete_key(timeline, side, key));
          break;
        case 1:
          static_cast<void>(copy_key(timeline, side, key, to_s));
          break;
        case 2:
          static_cast<void>(mirror(timeline, 0.0));
          break;
        case 3:
          static_cast<void>(
              retime(timeline, 0.8 + 4e-4 * static_cast<double>(random() % 1000), 0.5, 0.7));
          break;
        default:
          static_cast<void>(move_key(timeline, side, key, to_s));
        }
        cache.follow(timeline);
        for (int look = 0; look < 20; ++look) {
          const auto found = cache.nearest(to_s);
          if (found.shape) CHECK(found.shape->shape.block_count() > 0);
          if (random() % 8 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
        }
        if (edit % 10 != 9) continue;
        cache.wait();
        check_all(cache, timeline);
      }
    }
  }

  TEST_CASE("what an edit does not reach is kept, and is the same as if it were made again") {
    Timeline timeline = test::waved_timeline(model(), flow::Mode::type2);
    ShapeCache cache(model());
    cache.follow(timeline);
    cache.wait();
    const auto before = cache.nearest(0.2).shape;
    const std::size_t last = timeline.hands[0].keys.size() - 1;
    REQUIRE(blend_key(timeline, Side::left, last - 1, 0.9));
    cache.follow(timeline);
    cache.wait();
    CHECK(cache.nearest(0.2).shape == before);
    check_all(cache, timeline);
    REQUIRE(blend_key(timeline, Side::left, 1, 0.9));
    cache.follow(timeline);
    cache.wait();
    CHECK(cache.nearest(0.2).shape != before);
    CHECK_FALSE(same_bits(cache.nearest(0.2).shape->shape, before->shape));
    // Events, and where the timeline ends.
    const auto at_begin = cache.nearest(0.1).shape;
    timeline.events[2].time_s = 0.45;
    cache.follow(timeline);
    cache.wait();
    CHECK(cache.nearest(0.1).shape == at_begin);
    check_all(cache, timeline);
    timeline.duration_s = 0.6; // the events after it are then the last frame's
    cache.follow(timeline);
    cache.wait();
    CHECK(cache.nearest(0.1).shape == at_begin);
    check_all(cache, timeline);
  }

  TEST_CASE("what cannot be played is reported, and what comes after it is made") {
    Timeline timeline = test::waved_timeline(model(), flow::Mode::type1);
    ShapeCache cache(model());
    Timeline bad = timeline;
    bad.hands[0].keys.clear();
    cache.follow(bad);
    cache.wait();
    REQUIRE(cache.progress().error);
    CHECK(cache.progress().error->code == Errc::bad_input);
    CHECK_FALSE(cache.nearest(0.0).fresh);
    cache.follow(timeline);
    cache.wait();
    check_all(cache, timeline);
    cache.follow(timeline); // and goes while it works
  }
}

} // namespace shape_cache_test
