#include "gloves/glove_light.hpp"

#include <vector>

#include <doctest/doctest.h>

namespace glove_light_test {

using namespace nendo;
using nendo::gloves::GloveLight;

namespace {

class GloveWithDiary final : public driver::Glove {
public:
  explicit GloveWithDiary(bool light) { info_.abilities.light = light; }
  const driver::GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& /*ring*/) override { return {}; }
  void stop() noexcept override {}
  driver::GloveStats stats() const noexcept override { return {}; }
  void set_feedback(const driver::Feedback& feedback) noexcept override {
    given.push_back(feedback.light);
  }

  std::vector<bool> given;

private:
  driver::GloveInfo info_;
};

} // namespace

TEST_SUITE("glove_light") {
  TEST_CASE("the glove is told of changes only, and left dark") {
    GloveWithDiary glove(true);
    GloveLight light(glove);
    for (const bool lit : {false, true, true, false, true})
      light.show(lit);
    CHECK(light.is_lit());
    light.put_out();
    light.put_out();
    CHECK(glove.given == std::vector<bool>{true, false, true, false});
  }

  TEST_CASE("a glove without a light is left alone") {
    GloveWithDiary glove(false);
    GloveLight light(glove);
    light.show(true);
    CHECK_FALSE(light.is_lit());
    light.put_out();
    CHECK(glove.given.empty());
  }
}

} // namespace glove_light_test
