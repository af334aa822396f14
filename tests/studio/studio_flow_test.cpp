// Which screen of the studio follows which.

#include <doctest/doctest.h>

#include "studio/studio_flow.hpp"

namespace studio_flow_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

/// A studio that notes what it is to show.
class Flow final : public StudioFlow {
public:
  explicit Flow(bool has_edits) : StudioFlow(StudioOptions{}), has_edits_(has_edits) {}

  std::optional<Shape> choose() override { return take_next(); }
  session::Observer* observe(const session::RunOptions&, bool) override { return nullptr; }
  void show_error(const std::string&) override {}
  Result<void> end() override { return {}; }

  Wish left{};
  bool shows_timeline = false;

private:
  Wish left_for() const override { return left; }
  bool has_edits_to_lose() const override { return has_edits_; }
  void open(const Open&) override {}
  NamedGlove found_glove() const override { return {}; }
  void leave_screen() override {}
  void enter_timeline(const std::string&) override { shows_timeline = true; }
  void enter_calibration(const NamedGlove&) override {}

  bool has_edits_;
};

} // namespace

TEST_SUITE("studio_flow") {
  TEST_CASE("a run that ends by itself ends the studio, unless the timeline has unsaved edits") {
    Flow clean(false);
    CHECK_FALSE(clean.goes_on());
    Flow edited(true);
    CHECK(edited.goes_on());
    CHECK(edited.shows_timeline);
    Flow quit(true); // after the question about the edits
    quit.left = Quit{};
    CHECK_FALSE(quit.goes_on());
  }
}

} // namespace studio_flow_test
