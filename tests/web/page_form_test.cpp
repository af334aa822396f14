// The form as a message for the page, and what its users do to controls.

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/eventually.hpp"
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
    const std::size_t first = number_of(&red);
    CHECK(first >= first_form_picture);
    CHECK(form.has_new_pictures());
    CHECK_FALSE(form.has_new_pictures());
    CHECK(number_of(&blue) != first);
    form.forget_images();
    CHECK(number_of(&same) == first);
    CHECK(form.pictures().size() == 2);
    CHECK(form.pictures().at(first)->starts_with("\x89PNG"));
    PageForm other;
    other.begin({});
    other.part("ways");
    other.card("Moai", &red, "");
    CHECK_FALSE(form.pictures().contains(other.pictures().begin()->first));
  }

  TEST_CASE("a drawing is a list of shapes, by their kinds and colours") {
    using forms::Drawing;
    PageForm form;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    Drawing drawing{.width = 300.0, .height = 40.0, .takes_pointer = true};
    const auto image = std::make_shared<const render::Image>(render::Size{280, 112});
    const auto add = [&](Drawing::Kind kind, Drawing::Colour colour,
                         std::vector<Eigen::Vector2f> points, const char* words = "",
                         std::shared_ptr<const render::Image> picture = nullptr) {
      drawing.shapes.push_back(
          {kind, colour, std::move(points), Drawing::Colour::ink, words, std::move(picture)});
    };
    using enum Drawing::Kind;
    add(area, Drawing::Colour::chart, {{0, 0}, {10, 0}, {10.04F, 5.26F}});
    add(line, Drawing::Colour::accent, {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {3, 0}});
    drawing.diamond(30.0, 7.0, Drawing::Colour::accent, Drawing::Colour::ink);
    add(words, Drawing::Colour::ink, {{4, 7.5F}}, "a \"mark\" \xFF");
    add(picture, Drawing::Colour::ink, {{0, 56}, {70, 0}, {20, 0}, {90, 56}}, "", image);
    for (const float wrong : {nan, std::numeric_limits<float>::infinity()})
      add(area, Drawing::Colour::line, {{0, 0}, {wrong, 0}, {1, 1}});
    add(area, Drawing::Colour::line, {{0, 0}, {1, 1}});
    add(line, Drawing::Colour::line, {});
    add(picture, Drawing::Colour::line, {{0, 0}, {1, 1}, {0, 0}, {1, 1}}); // without an image
    add(picture, Drawing::Colour::line, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}, "", image);
    form.begin({});
    form.part("timeline");
    form.drawing("keys", "Help.", drawing);
    drawing.tooltip = "key 3";
    drawing.width = std::numeric_limits<double>::quiet_NaN();
    form.drawing("keys", "Help.", drawing);
    const Json controls = Json::parse(form.message("timeline"))["parts"][0]["controls"];
    CHECK(controls[0]["kind"] == "drawing");
    CHECK(controls[0]["id"] == "keys");
    CHECK(controls[0]["help"] == "Help.");
    CHECK(controls[0]["width"] == 300);
    CHECK(controls[0]["height"] == 40);
    CHECK(controls[0]["listens"] == true);
    const Json& shapes = controls[0]["shapes"];
    REQUIRE(shapes.size() == 5);
    CHECK(shapes[0].dump() == R"(["area","chart",0,0,10,0,10,5.3])");
    CHECK(shapes[1].dump() == R"(["line","accent",0,0,3,3,3,0])");
    CHECK(shapes[2].dump() == R"(["diamond","accent",30,7,"ink"])");
    CHECK(shapes[3][2] == 4);
    CHECK(shapes[3][3] == 7.5);
    CHECK(shapes[3][4].get<std::string>().starts_with("a \"mark\" "));
    const std::size_t number = shapes[4][1];
    CHECK(form.pictures().contains(number));
    CHECK(shapes[4].dump() == "[\"picture\"," + std::to_string(number) + ",20,0,70,56,110,210]");
    CHECK(controls[1]["id"] != "keys");
    CHECK(controls[1]["help"] == "key 3");
    CHECK(controls[1]["width"] == 1);
  }

  TEST_CASE("a curve keeps its form with fewer points") {
    PageForm form;
    forms::Drawing drawing{.width = 240.0, .height = 30.0};
    forms::Drawing::Shape curve{forms::Drawing::Kind::line, forms::Drawing::Colour::chart, {}};
    for (int point = 0; point < 240; ++point) {
      const auto x = static_cast<float>(point);
      curve.points.emplace_back(x, point < 120 ? 28.0F : 15.0F + 13.0F * std::sin(0.1F * x));
    }
    drawing.shapes.push_back(curve);
    form.begin({});
    form.part("edit");
    form.drawing("smile", "", drawing);
    const Json shape = Json::parse(form.message())["parts"][0]["controls"][0]["shapes"][0];
    REQUIRE(shape.size() > 10);
    CHECK(shape.size() < 2 + 2 * 80);
    std::size_t at = 2;
    for (const Eigen::Vector2f& point : curve.points) {
      while (shape[at + 2].get<float>() < point.x())
        at += 2;
      const float x0 = shape[at], y0 = shape[at + 1], x1 = shape[at + 2], y1 = shape[at + 3];
      const float share = (point.x() - x0) / (x1 - x0);
      CHECK(std::abs(y0 + share * (y1 - y0) - point.y()) <
            0.6F); // steep, a quarter of a pixel aside
    }
  }

  TEST_CASE("the pointer is pressed once, and held until it is released") {
    using Event = PointerInput::Event;
    PageForm form;
    forms::Drawing drawing{.width = 300.0, .height = 40.0, .takes_pointer = true};
    const auto after = [&](std::optional<PointerInput> input, const char* control = "keys") {
      form.begin(input ? std::optional(FormInput{control, "", FormKind::screen, input})
                       : std::nullopt);
      form.part("timeline");
      return form.drawing("keys", "", drawing);
    };
    CHECK(after({}).width == 0.0);
    CHECK_FALSE(after({}).at);
    CHECK(after(PointerInput{Event::size, 640.0}).width == 640.0);
    CHECK(after({}).width == 640.0);
    CHECK(after(PointerInput{Event::size, -1.0}).width == 0.0);
    auto pointer = after(PointerInput{Event::move, 3.0, 4.0, 5.0, -2.0, true});
    REQUIRE(pointer.at);
    CHECK(*pointer.at == Eigen::Vector2d(3.0, 4.0));
    CHECK(pointer.panned == 5.0);
    CHECK(pointer.wheel == -2.0);
    CHECK(pointer.has_control);
    pointer = after({});
    CHECK(pointer.at);
    CHECK(pointer.panned == 0.0);
    CHECK(pointer.wheel == 0.0);
    CHECK_FALSE(after(PointerInput{Event::drag, 3.0, 4.0}).is_held); // which did not begin here
    pointer = after(PointerInput{Event::down, 7.0, 8.0});
    CHECK(pointer.is_pressed);
    CHECK(pointer.is_held);
    pointer = after({});
    CHECK_FALSE(pointer.is_pressed);
    CHECK(pointer.is_held);
    pointer = after(PointerInput{Event::drag, -50.0, 8.0});
    CHECK(pointer.is_held);
    CHECK(pointer.at->x() == -50.0);
    CHECK(after(PointerInput{Event::up, 1.0, 1.0}, "other").is_held);
    CHECK_FALSE(after(PointerInput{Event::up, 9.0, 8.0}).is_held);
    CHECK(after({}).at->x() == 9.0);
    CHECK(after(PointerInput{Event::down}).is_held);
    CHECK_FALSE(after(PointerInput{Event::move}).is_held); // the release was lost
    CHECK_FALSE(after(PointerInput{Event::leave}).at);
    drawing.takes_pointer = false;
    pointer = after(PointerInput{Event::down});
    CHECK_FALSE(pointer.is_pressed);
    CHECK_FALSE(pointer.at);
  }

  TEST_CASE("the pointer presses only drawings, and a drawing takes nothing but the pointer") {
    using Event = PointerInput::Event;
    PageForm form;
    const forms::Drawing drawing{.width = 300.0, .height = 40.0, .takes_pointer = true};
    for (const std::string control : {"Play", "loop", "play"}) {
      form.begin(FormInput{control, "", FormKind::screen, PointerInput{Event::down}});
      CHECK(form.take_edit_command() == nullptr);
      form.part("timeline");
      CHECK_FALSE(form.button("Play", ""));
      bool loops = false;
      CHECK_FALSE(form.check("loop", "", loops));
    }
    form.begin(FormInput{"keys", "12"});
    form.part("timeline");
    CHECK_FALSE(form.drawing("keys", "", drawing).at);
  }

  TEST_CASE("a drawing that is no longer described is forgotten") {
    PageForm form;
    const forms::Drawing drawing{.width = 300.0, .height = 40.0, .takes_pointer = true};
    const auto width_after = [&](std::optional<FormInput> input) {
      form.begin(std::move(input));
      form.part("timeline");
      return form.drawing("keys", "", drawing).width;
    };
    const FormInput size{"keys", "", FormKind::screen,
                         PointerInput{PointerInput::Event::size, 640.0}};
    CHECK(width_after(size) == 640.0);
    form.begin(size); // another screen, which has no drawing
    CHECK(width_after({}) == 0.0);
  }

  TEST_CASE("pictures of drawings are bounded, and a number is never that of another picture") {
    PageForm form;
    std::map<std::size_t, std::string> seen;
    for (int picture = 0; picture < 300; ++picture) {
      // Each is where the previous one was, if the form does not hold that.
      const auto level = static_cast<std::uint8_t>(picture % 256);
      auto image =
          std::make_shared<const render::Image>(render::Size{16, 16}, render::Pixel{level, 0, 0});
      forms::Drawing drawing{.width = 100.0, .height = 16.0};
      using Points = std::vector<Eigen::Vector2f>;
      drawing.shapes.push_back({forms::Drawing::Kind::picture, forms::Drawing::Colour::ink,
                                Points{{0, 0}, {16, 16}, {0, 0}, {16, 16}},
                                forms::Drawing::Colour::ink, "", image});
      form.begin({});
      form.part("timeline");
      form.drawing("keys", "", drawing);
      form.drawing("more", "", drawing);
      const Json controls = Json::parse(form.message())["parts"][0]["controls"];
      const std::size_t number = controls[0]["shapes"][0][1];
      CHECK(controls[1]["shapes"][0][1] == number);
      REQUIRE(form.pictures().contains(number));
      CHECK(form.has_new_pictures());
      CHECK(seen.emplace(number, *form.pictures().at(number)).second);
      CHECK(form.pictures().size() <= PageForm::max_gone + 2);
      for (const auto& [kept, contents] : form.pictures())
        CHECK(*contents == seen.at(kept));
      const std::weak_ptr<const render::Image> released = image;
      image.reset();
      drawing.shapes.clear();
      CHECK_FALSE(released.expired()); // its address remains its own while it has a number
    }
    for (int many = 0; many < 2; ++many)
      form.begin({});
    CHECK(form.pictures().size() == PageForm::max_gone);
  }

  TEST_CASE("a command of the timeline is taken from the input by its name") {
    PageForm form;
    const auto taken = [&](const std::string& control, const std::string& value = "") {
      form.begin(FormInput{control, value});
      const auto* const row = form.take_edit_command();
      CHECK(form.take_edit_command() == nullptr);
      return row;
    };
    CHECK(taken("delete key") == &commands::row_of(commands::EditCommand::delete_key));
    CHECK(taken("play") == &commands::row_of(commands::EditCommand::play));
    CHECK(taken("grab") == nullptr);
    CHECK(taken("show hands") == nullptr);
    CHECK(taken("no command") == nullptr);
    CHECK(taken("play", "1") == nullptr);
    commands::EditFacts facts;
    facts.playing = true;
    form.begin({});
    form.part("timeline");
    CHECK_FALSE(form.command(commands::row_of(commands::EditCommand::play), facts));
    const Json controls = Json::parse(form.message())["parts"][0]["controls"];
    CHECK(controls[0]["name"] == "Pause");
    CHECK(controls[0]["look"] == "on");
  }

  TEST_CASE("a number is changing for a while after its last value") {
    PageForm form;
    float speed = 1.0F;
    const auto give = [&](std::optional<FormInput> input) {
      form.begin(std::move(input));
      form.part("timeline");
      form.number("speed", "", speed, 0.1F, 4.0F, "", 2);
      return form.is_changing();
    };
    CHECK_FALSE(give({}));
    CHECK_FALSE(give(FormInput{"speed", "fast"}));
    CHECK(give(FormInput{"speed", "2"}));
    CHECK(give({}));
    CHECK(give(FormInput{"speed", "2"})); // of a slider that is held
    CHECK(test::eventually([&] { return !give({}); }));
    CHECK(speed == 2.0F);
  }
}

} // namespace page_form_test
