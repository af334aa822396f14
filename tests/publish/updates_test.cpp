// What an update is for: a copy of the model that follows it becomes the published shape.

#include <cmath>

#include "publish/publish_fixtures.hpp"

using namespace nendo;
using namespace nendo::publish;
using deform::Points;
using flow::Mode;
using test::LoopUnderTest;
using test::MappedSegment;
using test::Player;
using test::segment_name;

namespace {

/// What FORMAT.md says of a field, for one point.
Eigen::Vector3d moved(const nendo_publish_field& field, const nendo_publish_function* functions,
                      const Eigen::Vector3d& x) {
  Eigen::Vector3d result = x;
  for (int row = 0; row < 3; ++row) {
    const double* const p = field.polynomial + 4 * row;
    result[row] += p[0] + p[1] * x[0] + p[2] * x[1] + p[3] * x[2];
  }
  for (std::uint32_t n = 0; n < field.functions; ++n) {
    const auto& f = functions[n];
    const double d = std::sqrt(std::pow(x[0] - f.centre[0], 2) + std::pow(x[1] - f.centre[1], 2) +
                               std::pow(x[2] - f.centre[2], 2));
    const double t = d / f.radius;
    REQUIRE(field.kernel == 1);
    if (t >= 1.0) continue;
    const double psi = std::pow(1.0 - t, 4) * (4.0 * t + 1.0);
    for (int axis = 0; axis < 3; ++axis)
      result[axis] += f.coefficient[axis] * psi;
  }
  return result;
}

Points through_fields(const std::vector<std::uint64_t>& record, const Points& from) {
  const auto& head = test::head_of(record);
  const std::uint64_t* at = record.data() + sizeof head / 8;
  Points shape = from;
  for (std::uint32_t n = 0; n < head.fields; ++n) {
    const auto& field = *reinterpret_cast<const nendo_publish_field*>(at);
    const auto* const functions = reinterpret_cast<const nendo_publish_function*>(&field + 1);
    for (Eigen::Index v = 0; v < shape.cols(); ++v)
      shape.col(v) = moved(field, functions, shape.col(v).eval());
    at += (sizeof field + field.functions * sizeof *functions) / 8;
  }
  CHECK(8 * static_cast<std::uint64_t>(at - record.data()) == sizeof head + head.fields_bytes);
  return shape;
}

/// Keeps a copy of the model by the updates alone, as FORMAT.md says.
struct Follower {
  Points rest, shape;
  std::uint64_t commits = 0, undos = 0;

  void follow(const std::vector<std::uint64_t>& record, const Points& published) {
    const auto& head = test::head_of(record);
    if (head.mode == 2) {
      shape = head.undos != undos ? published : through_fields(record, shape);
    } else {
      if (head.undos != undos) rest = published;
      shape = through_fields(record, rest);
      if (head.commits != commits) rest = shape;
    }
    commits = head.commits;
    undos = head.undos;
  }
};

} // namespace

TEST_SUITE("updates") {
  TEST_CASE(
      "the updates, with commits, undo and redo, make the published shapes of the rest shape") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, 10);
      SegmentPublisher publisher(segment_name("follow"), {});
      test::attach(test, {&publisher});
      REQUIRE(publisher.begin(test::outline_of(test)));
      const MappedSegment segment(segment_name("follow"));
      Follower follower{segment.rest(), segment.rest()};
      Player player(test);
      double furthest = 0.0;
      for (std::uint64_t number = 1; number <= 300; ++number) {
        player.next();
        const Points published = segment.shape(number);
        follower.follow(segment.record(number), published);
        REQUIRE((follower.shape - published).cwiseAbs().maxCoeff() < 1e-4);
        furthest = std::max(furthest, (published - test.model.vertices).cwiseAbs().maxCoeff());
      }
      CHECK(furthest > 1e-2);
      CHECK(follower.undos > 2);
      CHECK(follower.commits > 2);
    }
  }
}
