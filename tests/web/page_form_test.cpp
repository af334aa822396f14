// The form as a message for the page, and what its users do to controls.

#include <array>
#include <string_view>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "web/page_form.hpp"

namespace page_form_test {

using namespace nendo;
using namespace nendo::web;
using Json = nlohmann::json;

TEST_SUITE("page_form") {
  TEST_CASE("a button is pressed once, and of two with one name the one that is meant") {
    PageForm form;
    const auto describe = [&](std::optional<FormInput> input) {
      form.begin(std::move(input));
      form.part("ways");
      const bool first = form.button("Calibrate...", "help");
      const bool second = form.button("Calibrate...", "help");
      const bool grey = form.button("Keep", "", forms::Form::Look::grey);
      return std::array{first, second, grey};
    };
    CHECK(describe({}) == std::array{false, false, false});
    const Json message = Json::parse(form.message("start"));
    CHECK(message["screen"] == "start");
    const Json& controls = message["parts"][0]["controls"];
    REQUIRE(controls.size() == 3);
    CHECK(controls[0]["id"] != controls[1]["id"]);
    const std::string second = controls[1]["id"];
    CHECK(describe(FormInput{second, ""}) == std::array{false, true, false});
    CHECK(describe({}) == std::array{false, false, false});
    CHECK(describe(FormInput{"Keep", ""}) == std::array{false, false, false}); // not possible
    CHECK(describe(FormInput{"no such control", ""}) == std::array{false, false, false});
  }

  TEST_CASE("values are those of the control, whatever a client sends") {
    PageForm form;
    bool learns = false;
    float length_mm = 180.0F;
    std::size_t hands = 0;
    std::string name;
    constexpr std::array<std::string_view, 2> names{"gloves", "simulated"};
    const auto give = [&](const std::string& control, const std::string& value) {
      form.begin(FormInput{control, value});
      form.part("course");
      form.check("learn", "", learns);
      form.number("length", "", length_mm, 140.0F, 230.0F, "mm");
      form.choice("Hands", "", names, hands);
      form.line("your name", name);
    };
    give("learn", "true");
    CHECK(learns);
    give("learn", "yes");
    CHECK_FALSE(learns);
    for (const auto& [text, length] : {std::pair{"200.5", 200.5F},
                                       {"1e9", 230.0F},
                                       {"-1", 140.0F},
                                       {"nan", 140.0F},
                                       {"", 140.0F},
                                       {"1x", 140.0F}}) {
      const std::string value(text); // Clang 14 captures no structured binding
      CAPTURE(value);
      give("length", value);
      CHECK(length_mm == length);
    }
    give("Hands", "simulated");
    CHECK(hands == 1);
    give("Hands", "none");
    CHECK(hands == 1);
    give("your name", "anna \xFF");
    CHECK(name == "anna \xFF");
    CHECK(Json::accept(form.message("calibration")));
  }

  TEST_CASE("a picture has a number, the same when its screen comes again") {
    PageForm form;
    const render::Image red({16, 16}, {255, 0, 0}), same = red, blue({16, 16}, {0, 0, 255});
    const auto number_of = [&](const render::Image* image) {
      form.begin({});
      form.part("ways");
      form.card("Moai", image, "");
      return Json::parse(form.message("start"))["parts"][0]["controls"][0]["picture"];
    };
    CHECK(number_of(nullptr).is_null());
    CHECK(number_of(&red) == 0);
    CHECK(form.has_new_pictures());
    CHECK_FALSE(form.has_new_pictures());
    CHECK(number_of(&blue) == 1);
    form.forget_images();
    CHECK(number_of(&same) == 0);
    CHECK(form.pictures().size() == 2);
  }
}

} // namespace page_form_test
