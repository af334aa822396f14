// What an update is for: a copy of the model that follows it becomes the published shape.

#include <cmath>
#include <random>

#include "publish/publish_fixtures.hpp"

namespace updates_test {

using namespace nendo;
using namespace nendo::publish;
using deform::Points;
using flow::Mode;
using test::LoopUnderTest;
using test::MappedSegment;
using test::Player;
using test::segment_name;

namespace {

double wendland(std::uint32_t kernel, double t) {
  const double u = 1.0 - t;
  if (kernel == 0) return std::pow(u, 2);
  if (kernel == 1) return std::pow(u, 4) * (4.0 * t + 1.0);
  if (kernel == 2) return std::pow(u, 6) * (35.0 * t * t + 18.0 * t + 3.0) / 3.0;
  REQUIRE(kernel == 3);
  return std::pow(u, 8) * (32.0 * t * t * t + 25.0 * t * t + 8.0 * t + 1.0);
}

/// What FORMAT.md says of a field, for one point.
Eigen::Vector3d moved(const nendo_publish_field& field, const nendo_publish_function* functions,
                      const Eigen::Vector3d& x) {
  Eigen::Vector3d result = x;
  const bool keeps_volume = (field.kernel & NENDO_PUBLISH_KEEPS_VOLUME) != 0;
  const double keep = keeps_volume ? field.polynomial[0] : 0.0;
  for (int row = 0; row < 3 && !keeps_volume; ++row) {
    const double* const p = field.polynomial + 4 * row;
    result[row] += p[0] + p[1] * x[0] + p[2] * x[1] + p[3] * x[2];
  }
  for (std::uint32_t n = 0; n < field.functions; ++n) {
    const auto& f = functions[n];
    const double d = std::sqrt(std::pow(x[0] - f.centre[0], 2) + std::pow(x[1] - f.centre[1], 2) +
                               std::pow(x[2] - f.centre[2], 2));
    const double t = d / f.radius;
    if (t >= 1.0) continue;
    const double psi = wendland(field.kernel & 0xFFU, t);
    const double o4 = std::pow(1.0 - t, 4);
    const double identity = (1.0 - keep) * psi + keep * o4 * (1.0 + 4.0 * t - 20.0 * t * t);
    double along = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      along += (x[axis] - f.centre[axis]) / f.radius * f.coefficient[axis];
    for (int axis = 0; axis < 3; ++axis)
      result[axis] += identity * f.coefficient[axis] +
                      keep * 15.0 * o4 * along * (x[axis] - f.centre[axis]) / f.radius;
  }
  return result;
}

Points through_fields(const std::vector<std::uint64_t>& record, const Points& from) {
  const auto& head = test::head_of(record);
  const std::uint64_t* at = record.data() + sizeof head / 8;
  Points shape = from;
  Points places = from; // at which the next field is asked
  for (std::uint32_t n = 0; n < head.fields; ++n) {
    const auto& field = *reinterpret_cast<const nendo_publish_field*>(at);
    const auto* const functions = reinterpret_cast<const nendo_publish_function*>(&field + 1);
    const bool halfway = (field.kernel & NENDO_PUBLISH_HALFWAY) != 0;
    for (Eigen::Index v = 0; v < shape.cols(); ++v) {
      const Eigen::Vector3d place = places.col(v);
      const Eigen::Vector3d by = moved(field, functions, place) - place;
      if (!halfway) shape.col(v) += by;
      places.col(v) = halfway ? (shape.col(v) + by).eval() : shape.col(v).eval();
    }
    at += (sizeof field + field.functions * sizeof *functions) / 8;
  }
  CHECK(8 * static_cast<std::uint64_t>(at - record.data()) == sizeof head + head.fields_bytes);
  return shape;
}

/// Keeps a copy of the model by the updates, as FORMAT.md says; where these do not do, by the
/// published shape.
struct Follower {
  Points rest, shape;
  bool knows_rest = true;
  std::uint64_t number = 0, rest_changes = 0, jumps = 0;
  int followed = 0, taken = 0;

  void follow(const std::vector<std::uint64_t>& record, const Points& published) {
    const auto& head = test::head_of(record);
    const bool missed = head.number != number + 1;
    const bool committed = head.rest_changes != rest_changes;
    const bool undid = head.shape_jumps != jumps;
    if (head.mode == 2) {
      step(!missed && !undid, record, shape, published);
      rest = shape; // from which type-1 continues, should the mode change
      knows_rest = true;
    } else {
      if (missed && (committed || undid)) knows_rest = false;
      if (!missed && undid) {
        rest = published;
        knows_rest = true;
      }
      step(knows_rest, record, rest, published);
      if (!missed && committed) {
        rest = shape;
        knows_rest = true;
      }
    }
    number = head.number;
    rest_changes = head.rest_changes;
    jumps = head.shape_jumps;
  }

private:
  void step(bool by_fields, const std::vector<std::uint64_t>& record, const Points& from,
            const Points& published) {
    shape = by_fields ? through_fields(record, from) : published;
    ++(by_fields ? followed : taken);
  }
};

} // namespace

TEST_SUITE("updates") {
  TEST_CASE(
      "the updates, with commits, undo and redo, make the published shapes of the rest shape") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, {.rings_of_ball = 10});
      SegmentPublisher publisher(segment_name("follow"), {});
      test::attach(test, {&publisher});
      REQUIRE(publisher.begin(test::outline_of(test)));
      const MappedSegment segment(segment_name("follow"));
      Follower follower{segment.rest(), segment.rest()};
      Player player(test);
      double furthest = 0.0;
      for (std::uint64_t number = 1; number <= 400; ++number) {
        player.next();
        const Points published = segment.shape(number);
        follower.follow(segment.record(number), published);
        REQUIRE((follower.shape - published).cwiseAbs().maxCoeff() < 1e-4);
        furthest = std::max(furthest, (published - test.model.vertices).cwiseAbs().maxCoeff());
      }
      CHECK(furthest > 1e-2);
      CHECK(follower.jumps > 2);
      CHECK(follower.rest_changes > 2);
    }
  }

  TEST_CASE(
      "so they do while settings change from any to any, and not one record needs the shape for "
      "it") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, {.rings_of_ball = 10});
      SegmentPublisher publisher(segment_name("change"), {});
      test::attach(test, {&publisher});
      publish::LoopOutline outline = test::outline_of(test);
      outline.max_fields = 64;
      outline.functions = 20;
      REQUIRE(publisher.begin(outline));
      const MappedSegment segment(segment_name("change"));
      Follower follower{segment.rest(), segment.rest()};
      std::mt19937 random(5);
      const HostTime begin = HostClock::now();
      int bent = 0;
      for (std::uint64_t number = 1; number <= 400; ++number) {
        bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 30);
        test.bend(bent, begin + number * std::chrono::milliseconds(11));
        if (random() % 6 == 0) {
          auto settings = test::any_settings(test.loop->changes().settings(), random);
          settings.brushes = {}; // whose work no field describes
          static_cast<void>(test.loop->changes().change_settings(settings));
        }
        test.frame_after_tick(number - 1);
        const Points published = segment.shape(number);
        follower.follow(segment.record(number), published);
        REQUIRE((follower.shape - published).cwiseAbs().maxCoeff() < 1e-4);
      }
      CHECK(test.loop->stats().changes > 30);
      CHECK(follower.taken == 0);
    }
  }

  TEST_CASE("who misses records comes back to following the updates, and to the same shapes") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, {.rings_of_ball = 10});
      SegmentPublisher publisher(segment_name("miss"), {});
      test::attach(test, {&publisher});
      REQUIRE(publisher.begin(test::outline_of(test)));
      const MappedSegment segment(segment_name("miss"));
      Follower follower{segment.rest(), segment.rest()};
      Player player(test);
      std::mt19937 random(7);
      int by_fields_again = 0;
      for (std::uint64_t number = 1; number <= 600; ++number) {
        player.next();
        if (random() % 4 == 0) continue; // it was elsewhere
        const int taken = follower.taken;
        const bool missed = number != follower.number + 1;
        const Points published = segment.shape(number);
        follower.follow(segment.record(number), published);
        REQUIRE((follower.shape - published).cwiseAbs().maxCoeff() < 1e-4);
        if (missed && follower.taken == taken) ++by_fields_again;
      }
      CHECK(follower.taken > 20);
      CHECK(follower.followed > 100);
      if (mode == Mode::type1)
        CHECK(by_fields_again > 20); // one that only missed ticks need not ask
    }
  }
}

} // namespace updates_test
