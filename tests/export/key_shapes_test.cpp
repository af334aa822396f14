#include "export/morphs.hpp"

#include <random>

#include <doctest/doctest.h>

namespace key_shapes_test {

using nendo::exporting::KeyShapes;

namespace {

struct Kept {
  std::vector<float> times_s;
  std::vector<KeyShapes::Shape> shapes;
  double said = 0.0;
};

Kept keep(const std::vector<KeyShapes::Shape>& frames, const std::vector<float>& times_s,
          double tolerance, std::size_t max_bytes = std::size_t{1} << 20) {
  Kept kept;
  KeyShapes keys(
      tolerance,
      [&](float time_s, const KeyShapes::Shape& shape) {
        kept.times_s.push_back(time_s);
        kept.shapes.push_back(shape);
      },
      max_bytes);
  for (std::size_t at = 0; at < frames.size(); ++at)
    keys.add(times_s[at], frames[at]);
  keys.finish();
  kept.said = keys.greatest_error();
  return kept;
}

/// The farthest that a vertex is off if the keys are joined by straight lines.
double off(const Kept& kept, const std::vector<KeyShapes::Shape>& frames,
           const std::vector<float>& times_s) {
  double worst = 0.0;
  std::size_t next = 0;
  for (std::size_t at = 0; at < frames.size(); ++at) {
    while (kept.times_s[next] < times_s[at])
      ++next;
    Eigen::Matrix3Xd between = kept.shapes[next].cast<double>();
    if (kept.times_s[next] > times_s[at]) {
      const double from_s = static_cast<double>(kept.times_s[next - 1]);
      const double share = (static_cast<double>(times_s[at]) - from_s) /
                           (static_cast<double>(kept.times_s[next]) - from_s);
      between = share * between + (1.0 - share) * kept.shapes[next - 1].cast<double>();
    }
    worst = std::max(worst, (between - frames[at].cast<double>()).colwise().norm().maxCoeff());
  }
  return worst;
}

std::vector<float> even_times(std::size_t count) {
  std::vector<float> times_s;
  for (std::size_t at = 0; at < count; ++at)
    times_s.push_back(static_cast<float>(at) / 90.0F);
  return times_s;
}

} // namespace

TEST_SUITE("key_shapes") {
  TEST_CASE("no frame is farther off than is said, nor than is allowed, however they move") {
    std::mt19937 random(5);
    std::normal_distribution<float> step(0.0F, 0.01F);
    for (const double tolerance : {1e-4, 0.01, 0.05}) {
      std::vector<KeyShapes::Shape> frames;
      std::vector<float> times_s;
      KeyShapes::Shape shape = KeyShapes::Shape::Zero(3, 20);
      KeyShapes::Shape speed = shape;
      for (int at = 0; at < 300; ++at) {
        speed += KeyShapes::Shape::NullaryExpr(3, 20, [&] { return 0.1F * step(random); });
        shape += speed;
        frames.push_back(shape);
        times_s.push_back((times_s.empty() ? 0.0F : times_s.back()) + 0.001F +
                          std::abs(step(random)));
      }
      const Kept kept = keep(frames, times_s, tolerance);
      CHECK(kept.times_s.front() == times_s.front());
      CHECK(kept.times_s.back() == times_s.back());
      CHECK(kept.said <= tolerance);
      CHECK(off(kept, frames, times_s) == doctest::Approx(kept.said).epsilon(0.01));
      if (tolerance > 0.02) CHECK(kept.times_s.size() < 150);
    }
  }

  TEST_CASE("what moves straight needs two keys, a corner one more") {
    std::vector<KeyShapes::Shape> frames;
    for (int at = 0; at < 50; ++at)
      frames.push_back(KeyShapes::Shape::Constant(3, 4, static_cast<float>(std::abs(at - 20))));
    const Kept kept = keep(frames, even_times(50), 1e-4);
    REQUIRE(kept.times_s.size() == 3);
    CHECK(kept.times_s[1] == even_times(50)[20]);
  }

  TEST_CASE("long straight ways and little memory cost keys, not truth") {
    const auto times_s = even_times(400);
    std::vector<KeyShapes::Shape> frames;
    for (int at = 0; at < 400; ++at)
      frames.push_back(KeyShapes::Shape::Constant(3, 4, 0.01F * static_cast<float>(at)));
    const Kept all = keep(frames, times_s, 1e-4);
    CHECK(all.times_s.size() <= 1 + (400 + KeyShapes::max_between) / (KeyShapes::max_between + 1));
    const Kept few = keep(frames, times_s, 1e-4, 5 * 48);
    CHECK(few.times_s.size() > all.times_s.size());
    CHECK(off(few, frames, times_s) < 1e-4);
  }

  TEST_CASE("one frame is one key") {
    CHECK(keep({KeyShapes::Shape::Ones(3, 2)}, {0.0F}, 1e-4).times_s.size() == 1);
  }
}

} // namespace key_shapes_test
