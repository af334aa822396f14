// Settings that exclude each other: the command line and a loop that runs give the same reason.

#include <array>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/flow/setting.hpp>

#include "support/flow_fixtures.hpp"
#include "support/program.hpp"

namespace compatible_test {

using namespace nendo;
using flow::LoopSettings;
using flow::Mode;

namespace {

constexpr std::array<deform::Brush, 5> inflate{deform::Brush::inflate};

struct Pair {
  std::vector<std::string> options;
  LoopSettings settings;   ///< but for the radii
  bool plays = false;      ///< the puppet of the loop
  bool is_refused = false; ///< by the loop; otherwise one of them has no effect there
};

const std::vector<Pair> pairs{
    {{"--mode", "clay", "--puppet", "face"}, {.mode = Mode::clay}, true, true},
    {{"--mode", "parts", "--puppet", "face"}, {.mode = Mode::parts}, true, true},
    {{"--keep-volume", "1", "--puppet", "face"}, {.keep_volume = 1.0}, true, true},
    {{"--hold", "hand", "--puppet", "face"}, {.hold = flow::Hold::hand}, true},
    {{"--brush", "inflate,pull,pull,pull,pull", "--puppet", "face"},
     {.mode = Mode::type2, .brushes = inflate},
     true},
    {{"--injective", "--puppet", "face"}, {.injective = true}, true},
    {{"--mode", "clay", "--hold", "hand"}, {.mode = Mode::clay, .hold = flow::Hold::hand}},
    {{"--mode", "parts", "--keep-volume", "1"}, {.mode = Mode::parts, .keep_volume = 1.0}},
    {{"--mode", "clay", "--brush", "inflate,pull,pull,pull,pull"},
     {.mode = Mode::clay, .brushes = inflate}},
    {{"--mode", "type1", "--brush", "inflate,pull,pull,pull,pull"}, {.brushes = inflate}},
    {{"--mode", "type2", "--hold", "hand"}, {.mode = Mode::type2, .hold = flow::Hold::hand}},
    {{"--hold", "hand", "--keep-volume", "1"}, {.keep_volume = 1.0, .hold = flow::Hold::hand}},
    {{"--keep-volume", "1", "--injective"}, {.injective = true, .keep_volume = 1.0}},
};

/// What stands after the names of both.
std::string reason_in(const std::string& message) {
  const auto colon = message.find(": ");
  return colon == std::string::npos ? std::string() : message.substr(colon);
}

} // namespace

TEST_SUITE("compatible") {
  TEST_CASE("all pairs that exclude each other have one reason, wherever they are chosen") {
    for (const Pair& pair : pairs) {
      CAPTURE(pair.options.back());
      test::LoopFixture fixture{.rings_of_ball = 6};
      if (pair.plays) fixture.puppet = test::ball_puppet; // along the surface, as the face's
      test::LoopUnderTest test(Mode::type1, fixture);
      LoopSettings settings = pair.settings;
      settings.radius_m = test.loop->changes().settings().radius_m;
      const auto changed = test.loop->changes().change_settings(settings);
      CHECK(bool(changed) == !pair.is_refused);
      const auto live =
          flow::all_effective(settings, flow::played_by(test.loop->changes().puppet(0).get()));
      REQUIRE_FALSE(live);
      if (!changed) CHECK(changed.error().message == live.error().message);
      CHECK(live.error().message.find("--") == std::string::npos);

      std::vector<std::string> command{"run", "--right", "sim"};
      command.insert(command.end(), pair.options.begin(), pair.options.end());
      const auto done = test::nendo(command);
      CHECK(done.exit_code == 2);
      const std::string reason = reason_in(live.error().message);
      REQUIRE(!reason.empty());
      CHECK(done.err.find(reason) != std::string::npos);
      for (const std::string& option : pair.options)
        if (option.starts_with("--")) CHECK(done.err.find(option) != std::string::npos);
    }
  }

  TEST_CASE("what one setting has of its own excludes nothing") {
    const LoopSettings usual;
    for (const auto played :
         {flow::Played::nothing, flow::Played::through_air, flow::Played::along_surface})
      CHECK(flow::all_effective(usual, played));
    for (const Mode mode : {Mode::type1, Mode::type2, Mode::clay, Mode::parts})
      CHECK(flow::all_effective({.mode = mode, .injective = true}, flow::Played::nothing));
    CHECK(flow::all_effective({.mode = Mode::type2, .brushes = inflate}, flow::Played::nothing));
    CHECK(flow::all_effective({.keep_volume = 1.0}, flow::Played::through_air));
  }
}

} // namespace compatible_test
