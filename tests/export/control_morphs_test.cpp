#include "export/morphs.hpp"

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/recorded_motion.hpp"

namespace control_morphs_test {

using namespace nendo;
using nendo::exporting::ControlMorphs;

namespace {

/// A frame of the model at rest, which so many of its vertices hold.
flow::Frame still_frame(const deform::BlockLayout& layout, Eigen::Index centres) {
  deform::CsrbfField field;
  field.centres = layout.original().leftCols(centres);
  field.radii = Eigen::VectorXd::Constant(centres, 0.5);
  field.coefficients = deform::Points::Zero(3, centres);
  flow::Frame frame;
  frame.fields = deform::FieldSequence(1, field);
  frame.fields.push(field);
  return frame;
}

} // namespace

TEST_SUITE("control_morphs") {
  TEST_CASE("the frames before one that cannot be added remain, as the shapes that they have") {
    const test::RecordedMotion motion(test::Motion{.commit_at_tick = 20});
    const auto source = motion.frames();
    ControlMorphs morphs(source->layout(0));
    deform::Points vertices;
    std::size_t added = 0;
    while (source->next()) {
      source->layout(0).unpack(source->frame().shape, vertices);
      if (!morphs.add(source->frame(), vertices)) break;
      ++added;
    }
    REQUIRE(added >= 20);
    REQUIRE(added < motion.shapes.size());
    const deform::Points& rest = source->layout(0).original();
    CHECK(test::farthest(motion.shapes[added - 1], rest) > 0.003 * motion.diagonal());
    for (std::size_t at = 0; at < added; ++at)
      CHECK(test::farthest(rest + morphs.displacement(at).cast<double>(), motion.shapes[at]) <
            1e-6 * motion.diagonal());
    CHECK(morphs.greatest_error() < 1e-6 * motion.diagonal());
  }

  TEST_CASE("a frame with another number of start points is not of the same control vectors") {
    const deform::BlockLayout layout(test::ball(8).vertices);
    for (const Eigen::Index more : {Eigen::Index{2}, Eigen::Index{4}}) {
      ControlMorphs morphs(layout);
      CHECK(morphs.add(still_frame(layout, 3), layout.original()));
      CHECK_FALSE(morphs.add(still_frame(layout, more), layout.original()));
    }
  }
}

} // namespace control_morphs_test
