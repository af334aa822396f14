#include <array>
#include <string>

#include <doctest/doctest.h>

#include "web/client_commands.hpp"

namespace client_commands_test {

using namespace nendo;
using namespace nendo::web;

namespace {

template <class T>
std::optional<T> parsed_as(std::string_view text) {
  const auto asked = parse_command(text);
  if (!asked) return std::nullopt;
  const auto* const row = std::get_if<const commands::Row*>(&*asked);
  const flow::Command command =
      row != nullptr ? (*row)->make(false) : std::get<flow::Command>(*asked);
  if (!std::holds_alternative<T>(command)) return std::nullopt;
  return std::get<T>(command);
}

} // namespace

TEST_SUITE("client_commands") {
  TEST_CASE("every request of the loop is one by its name") {
    for (const auto request : flow::requests)
      CHECK(parsed_as<flow::Request>(flow::name_of(request)) == request);
  }

  TEST_CASE("a recording's begin and end, and what is to be saved are commands") {
    CHECK(parsed_as<flow::SetRecording>("record") == flow::SetRecording{true});
    CHECK(parsed_as<flow::SetRecording>("end recording") == flow::SetRecording{false});
    CHECK(parsed_as<flow::SaveShape>("save"));
    CHECK(parsed_as<flow::Mark>("mark"));
    CHECK(parsed_as<flow::Punch>("punch"));
    CHECK(parsed_as<flow::Refine>("refine"));
    CHECK_FALSE(parse_command("punch in"));
    CHECK_FALSE(parse_command("mark 1"));
    CHECK(parsed_as<flow::SetClutch>("clutch left all off") ==
          flow::SetClutch{Side::left, puppet::RigPlayer::all_fingers, false});
    CHECK(parsed_as<flow::SetClutch>("clutch right ring on") ==
          flow::SetClutch{Side::right, 3, true});
    CHECK(parsed_as<flow::SetMask>("mask clear") == flow::SetMask{});
    CHECK(parsed_as<flow::SetMask>("mask invert") == flow::SetMask{flow::MaskEdit::invert});
    CHECK(parsed_as<flow::SetMask>("mask hold 1 -2 0.5 0.25") ==
          flow::SetMask{flow::MaskEdit::hold, {1.0, -2.0, 0.5}, 0.25});
    CHECK(parsed_as<flow::SetMask>("mask free 1 2 3 4") ==
          flow::SetMask{flow::MaskEdit::free, {1.0, 2.0, 3.0}, 4.0});
    for (const auto* wrong : {"mask", "mask paint", "mask clear all", "mask hold",
                              "mask hold 1 2 3", "mask hold 1 2 3 0", "mask hold 1 2 3 -1",
                              "mask hold 1 2 3 4 5", "mask free 1e99 2 3 4", "mask hold nan 2 3 4"})
      CHECK_FALSE(parse_command(wrong));
    CHECK(parsed_as<flow::SetSymmetry>("symmetry on") == flow::SetSymmetry{true});
    CHECK(parsed_as<flow::SetRole>("role 3 left.index_flexion") ==
          flow::SetRole{3, *puppet::HandSignal::named("left.index_flexion")});
    for (const auto* wrong :
         {"clutch left all", "clutch both all on", "clutch left toe on", "clutch left all maybe",
          "symmetry yes", "symmetry on on", "role 3", "role 64 left.index_flexion",
          "role 1.5 left.index_flexion", "role -1 left.index_flexion", "role 3 left.tail",
          "role 3 left.index_flexion now"})
      CHECK_FALSE(parse_command(wrong));
    CHECK(parsed_as<flow::SaveRecording>("keep"));
  }

  TEST_CASE("settings are mode, kernel, whether it may fold, filter and five radii in metres") {
    const auto change = parsed_as<flow::ChangeSettings>(
        "settings type2 c4 injective one-euro 0.1 0.125 0.08 1e-2 10 pull pull pull pull pull 0.5");
    REQUIRE(change);
    CHECK(change->settings.mode == flow::Mode::type2);
    CHECK(change->settings.kernel == deform::Wendland::c4);
    CHECK(change->settings.injective);
    CHECK(change->settings.filter.kind == hand::FilterKind::one_euro);
    CHECK(change->settings.radius_m == std::array{0.1, 0.125, 0.08, 0.01, 10.0});
    CHECK(change->settings.are_usable());
    for (const auto* kernel : {"c0", "c2", "c6"}) {
      const auto other =
          parsed_as<flow::ChangeSettings>("settings type1 " + std::string(kernel) +
                                          " free off 1 1 1 1 1 push none scale twist smooth -1");
      REQUIRE(other);
      CHECK(other->settings.brushes == std::array{deform::Brush::push, deform::Brush::none,
                                                  deform::Brush::scale, deform::Brush::twist,
                                                  deform::Brush::smooth});
      CHECK(other->settings.brush_strength == -1.0);
      CHECK_FALSE(other->settings.injective);
      CHECK(other->settings.filter.kind == hand::FilterKind::off);
    }
  }

  TEST_CASE("settings may tell how much of the volume stays, and what of a hand holds") {
    const std::string settings =
        "settings type1 c2 free off 1 1 1 1 1 pull pull pull pull pull 0.5";
    const auto plain = parsed_as<flow::ChangeSettings>(settings);
    REQUIRE(plain);
    CHECK(plain->settings.keep_volume == 0.0);
    CHECK(plain->settings.hold == flow::Hold::fingertips);
    const auto clay = parsed_as<flow::ChangeSettings>(settings + " 0.25 hand");
    REQUIRE(clay);
    CHECK(clay->settings.keep_volume == 0.25);
    CHECK(clay->settings.hold == flow::Hold::hand);
    for (const auto* wrong : {" 0.25", " 1.5 tips", " -0.1 tips", " nan hand", " 1 fist", " hand 1",
                              " 1 hand ", " 1 hand 1"}) {
      CAPTURE(wrong);
      CHECK_FALSE(parse_command(settings + wrong));
    }
  }

  TEST_CASE("a wrist's place and turn are taken as they are, but for the quaternion's length") {
    const auto move = parsed_as<flow::WristMove>("wrist left 0.25 -1.5 100 0 0.6 0 0.8");
    REQUIRE(move);
    CHECK(move->side == Side::left);
    CHECK(move->position_m == std::array{0.25, -1.5, 100.0});
    CHECK(move->turn_xyzw[1] == doctest::Approx(0.6).epsilon(1e-15));
    const auto rough = parsed_as<flow::WristMove>("wrist right 0 0 0 0 0 0 -0.995");
    REQUIRE(rough);
    CHECK(rough->side == Side::right);
    CHECK(rough->turn_xyzw == std::array{0.0, 0.0, 0.0, -1.0});
    CHECK(rough->is_usable());
  }

  TEST_CASE("whatever else is said is nothing: other words, spaces, numbers that are none or too "
            "large, too many of them and too few") {
    const std::array<std::string, 54> wrong{
        "",
        " ",
        "Grab",
        "grab ",
        " grab",
        "reset now",
        "record ",
        "end  recording",
        "format the disk",
        "settings",
        "settings ",
        "settings type3 c2 free off 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c8 free off 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 wendland-c2 free off 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off",
        "settings type1 c2 free off 1 1 1 1 1",
        "settings type1 c2 free off 1 1 1 1 1 pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1 pull pull pull pull paint 0.5",
        "settings type1 c2 free off 1 1 1 1 1 pull pull pull pull pull",
        "settings type1 c2 free off 1 1 1 1 1 pull pull pull pull pull 1.5",
        "settings type1 c2 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 folds off 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 free kalman 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 off free 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 injective 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1  pull pull pull pull pull 0.5",
        "settings type1 c2 free off  1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings  type1 c2 free off 1 1 1 1 1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 nan pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 inf pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 -1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 0 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 9e-10 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1.1e9 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1e999 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 0x1 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1,0 pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1 1 1 1 1m pull pull pull pull pull 0.5",
        "settings type1 c2 free off 1\t1 1 1 1 pull pull pull pull pull 0.5",
        std::string("settings type1 c2 free off 1 1 1 1 1\0", 37),
        "wrist",
        "wrist left",
        "wrist both 0 0 0 0 0 0 1",
        "wrist Left 0 0 0 0 0 0 1",
        "wrist left 0 0 0 0 0 0",
        "wrist left 0 0 0 0 0 0 1 0",
        "wrist left 0 0 0 0 0 0 0",
        "wrist left 0 0 0 0 0 0 1.02",
        "wrist left 100.1 0 0 0 0 0 1",
        "wrist left 0 1e300 0 0 0 0 1",
        "wrist left 0 0 0 1e300 0 0 1",
        "wrist left 0 nan 0 0 0 0 1",
    };
    for (const std::string& text : wrong) {
      CAPTURE(text);
      CHECK_FALSE(parse_command(text));
    }
  }
}

} // namespace client_commands_test
