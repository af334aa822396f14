#include <array>
#include <string>

#include <doctest/doctest.h>

#include <nendo/flow/setting.hpp>

#include "commands/command_text.hpp"
#include "web/client_commands.hpp"
#include "web/web_socket.hpp"

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

  TEST_CASE("settings are named, and only those that are named change") {
    flow::LoopSettings settings;
    settings.radius_m = {0.1, 0.2, 0.3, 0.4, 0.5};
    settings.filter.min_cutoff_hz = 3.5;
    flow::LoopSettings wanted = settings;
    const auto take = [&](const std::string& text) {
      CAPTURE(text);
      const auto asked = parse_command("settings " + text);
      REQUIRE(asked);
      const auto* const named = std::get_if<NamedSettings>(&*asked);
      REQUIRE(named != nullptr);
      named->apply_to(settings);
    };
    take("mode=type2");
    wanted.mode = flow::Mode::type2;
    CHECK(settings == wanted);
    take("radius_m=0.1,0.125,0.08,1e-2,10 filter=one-euro injective=true");
    wanted.radius_m = {0.1, 0.125, 0.08, 0.01, 10.0};
    wanted.filter.kind = hand::FilterKind::one_euro;
    wanted.injective = true;
    CHECK(settings == wanted);
    take("brushes=push,none,scale,twist,smooth brush_strength=-1 kernel=wendland-c6");
    wanted.brushes = {deform::Brush::push, deform::Brush::none, deform::Brush::scale,
                      deform::Brush::twist, deform::Brush::smooth};
    wanted.brush_strength = -1.0;
    wanted.kernel = deform::Wendland::c6;
    CHECK(settings == wanted);
    take("injective=false keep_volume=0.25 hold=hand radius_m=0.2 brushes=pull");
    wanted.injective = false;
    wanted.keep_volume = 0.25;
    wanted.hold = flow::Hold::hand;
    wanted.radius_m.fill(0.2);
    wanted.brushes.fill(deform::Brush::pull);
    CHECK(settings == wanted);
  }

  TEST_CASE("all settings as a text are read back, and are a message that a client may send") {
    const flow::LoopSettings settings{.mode = flow::Mode::parts,
                                      .kernel = deform::Wendland::c0,
                                      .injective = true,
                                      .radius_m = {0.1 / 3, 0.2 / 3, 0.4 / 3, 0.5 / 3, 0.7 / 3},
                                      .piece_fraction = 0.1 / 7,
                                      .filter = {.kind = hand::FilterKind::one_euro},
                                      .brushes = {deform::Brush::flatten, deform::Brush::inflate,
                                                  deform::Brush::inflate, deform::Brush::inflate,
                                                  deform::Brush::inflate},
                                      .brush_strength = -0.1 / 3,
                                      .keep_volume = 0.1 / 3,
                                      .hold = flow::Hold::hand};
    const std::string text = "settings " + commands::text_of(settings);
    CHECK(text.size() < max_client_message / 2);
    const auto asked = parse_command(text);
    REQUIRE(asked);
    flow::LoopSettings read;
    std::get<NamedSettings>(*asked).apply_to(read);
    CHECK(read == settings);
  }

  TEST_CASE("a command as a text is the message that asks for it") {
    const flow::WristMove move{Side::left, {0.1 / 3, -2.0, 1e-7}, {0.5, 0.5, -0.5, 0.5}};
    const flow::SetMask mask{flow::MaskEdit::hold, {0.1 / 3, -2.0, 1e-7}, 0.25};
    const auto signal = puppet::HandSignal::named("left.index_flexion");
    REQUIRE(signal);
    for (const flow::Command& command : std::initializer_list<flow::Command>{
             flow::Request::grab,
             flow::Request::release,
             flow::Request::commit,
             flow::Request::undo,
             flow::Request::redo,
             flow::Request::reset,
             flow::Request::regrab,
             flow::Mark{},
             flow::SaveShape{},
             flow::Subdivide{},
             flow::Refine{},
             flow::ChangeTopology{},
             flow::Recentre{},
             flow::SetRecording{true},
             flow::SetRecording{false},
             flow::SetClutch{Side::left, 2, false},
             flow::SetClutch{Side::right, puppet::RigPlayer::all_fingers, true},
             flow::SetClutch{Side::right, puppet::HandSignal::no_finger, false},
             flow::SetRole{3, *signal},
             flow::SetSymmetry{true},
             flow::SetSymmetry{false},
             flow::DrawWire{true},
             flow::DrawWire{false},
             flow::DrawWire{true, flow::Blade::knife},
             mask,
             flow::SetMask{flow::MaskEdit::invert},
             flow::EditPart{},
             flow::EditPart{true},
             move}) {
      const std::string text = commands::text_of(command);
      CAPTURE(text);
      const auto asked = parse_command(text);
      REQUIRE(asked);
      const auto* const row = std::get_if<const commands::Row*>(&*asked);
      const flow::Command made =
          row != nullptr ? (*row)->make(false) : std::get<flow::Command>(*asked);
      CHECK(made == command);
    }
    CHECK(commands::text_of(flow::ChangePuppet{7}) == "puppet 7");
    CHECK(commands::text_of(flow::SetLayer{2, false}) == "layer 2 off");
    CHECK(commands::text_of(flow::EditPart{true, 4}) == "remove part 4");
    CHECK(commands::text_of(flow::ChangeModel{1, flow::ModelSource::cut}) == "cut");
    CHECK(commands::text_of(flow::ChangeModel{1, flow::ModelSource::refined, 100}) == "refine");
  }

  TEST_CASE(
      "a setting that is refused is named, with what can be used, in a close frame's length") {
    const auto refusal = [](const std::string& text) {
      const auto asked = parse_command("settings " + text);
      CHECK_FALSE(asked);
      return asked ? std::string() : asked.error().message;
    };
    CHECK(refusal("colour=red") == "there is no setting 'colour'; message 4 names all settings");
    CHECK(refusal("mode=type1 mode=type2") == "mode is there twice; name each setting once");
    CHECK(refusal("keep_volume=1.5") == "keep_volume: use 0 to 1");
    CHECK(refusal("beta_hz_per_rad_s=-1") == "beta_hz_per_rad_s: use 0 to 1000 Hz per rad/s");
    CHECK(refusal("injective=on") == "injective: use true or false");
    CHECK(refusal("brush_strength=strong") == "brush_strength: use a number");
    for (const std::string text : {
             "",
             " ",
             "mode",
             "mode=",
             "=type1",
             "mode=type3",
             "mode=type1 ",
             " mode=type1",
             "mode=type1  hold=hand",
             "mode=type1\thold=hand",
             "mode =type1",
             "Mode=type1",
             "type1 wendland-c2",
             "kernel=c2",
             "kernel=wendland-c8",
             "hold=fist",
             "filter=kalman",
             "min_cutoff_hz=0.001",
             "pinches=open",
             "brushes=paint",
             "brushes=pull,pull,pull,pull",
             "brushes=pull,pull,pull,pull,pull,pull",
             "brushes=pull,pull,pull,pull,pull,",
             "radius_m=",
             "radius_m=1,1,1,1",
             "radius_m=1,1,1,1,1,1",
             "radius_m=1,1,1,1,1,",
             "radius_m=1,1,1,1,nan",
             "radius_m=1,1,1,1,inf",
             "radius_m=1,1,1,1,-1",
             "radius_m=1,1,1,1,1.1e9",
             "radius_m=9e-10",
             "radius_m=1e999",
             "radius_m=0x1",
             "radius_m=1m",
             "radius_m=1 1 1 1 1",
             "piece_fraction=0",
             "brush_strength=-1.1",
             "keep_volume=nan",
         }) {
      CAPTURE(text);
      const std::string why = refusal(text);
      CHECK_FALSE(why.empty());
      CHECK(why.size() <= max_close_reason);
    }
    CHECK(refusal(std::string("keep_volume=1\0", 14)) == "keep_volume: use a number");
    CHECK(refusal(std::string(1000, 'x')).size() <= max_close_reason);
    flow::for_each_setting([&](const auto& setting) {
      const std::string why = refusal(std::string(setting.name) + "=\x1B");
      CHECK(why.starts_with(std::string(setting.name) + ": use "));
      CHECK(why.size() <= max_close_reason);
    });
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
    const std::array<std::string, 21> wrong{
        "",
        " ",
        "Grab",
        "grab ",
        " grab",
        "reset now",
        "record ",
        "end  recording",
        "format the disk",
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

  TEST_CASE("the input of a form is the id of a control, and its value") {
    const auto pressed = parse_form_input("form\tOpen a file...\t");
    REQUIRE(pressed);
    CHECK(pressed->control == "Open a file...");
    CHECK(pressed->value.empty());
    const auto typed = parse_form_input("form\tfile name\tmy scan.obj");
    REQUIRE(typed);
    CHECK(typed->value == "my scan.obj");
    CHECK(typed->form == FormKind::screen);
    const auto moved = parse_form_input("panel\tradius\t12");
    REQUIRE(moved);
    CHECK(moved->form == FormKind::run);
    for (const auto* wrong : {"form", "form\t", "form\t\tvalue", "form x", "formula\ta\tb",
                              "form\ta\tb\tc", "form\ta\tb\nc"}) {
      CAPTURE(wrong);
      CHECK_FALSE(parse_form_input(wrong));
    }
  }

  TEST_CASE("the input of a drawing is an event of the pointer, with five finite numbers") {
    using Event = PointerInput::Event;
    const auto wheel = parse_form_input("form\tkeys\tmove\t12.5 -3 0 -2 1");
    REQUIRE(wheel);
    REQUIRE(wheel->pointer);
    CHECK(wheel->control == "keys");
    CHECK(wheel->value.empty());
    CHECK(wheel->pointer->event == Event::move);
    CHECK(wheel->pointer->x == 12.5);
    CHECK(wheel->pointer->y == -3.0);
    CHECK(wheel->pointer->panned == 0.0);
    CHECK(wheel->pointer->wheel == -2.0);
    CHECK(wheel->pointer->has_control);
    const auto far = parse_form_input("panel\tkeys\tdrag\t1e300 -1e300 0 0 0");
    REQUIRE(far);
    REQUIRE(far->pointer);
    CHECK(far->form == FormKind::run);
    CHECK(far->pointer->x == PointerInput::max_number);
    CHECK(far->pointer->y == -PointerInput::max_number);
    CHECK_FALSE(parse_form_input("form\tname\tmove")->pointer); // a text that is typed
    for (const std::string numbers : {"", "1 2 3 4", "1 2 3 4 5 6", "nan 0 0 0 0", "0 inf 0 0 0",
                                      "0 0 x 0 0", "0  0 0 0 0", "0 0 0 0 0 ", "0 0 0 0 0\t"}) {
      CAPTURE(numbers);
      CHECK_FALSE(parse_form_input("form\tkeys\tmove\t" + numbers));
      CHECK_FALSE(parse_form_input("form\tkeys\tjump\t0 0 0 0 0"));
      CHECK_FALSE(parse_form_input("form\t\tmove\t0 0 0 0 0"));
    }
  }

  TEST_CASE("an input takes in the next one if both have the effect of one") {
    using Event = PointerInput::Event;
    const auto event = [](Event kind, double x = 0.0, const char* control = "keys") {
      return FormInput{control, "", FormKind::screen, PointerInput{kind, x, 0.0, 2.0, 1.0}};
    };
    FormInput moved = event(Event::move, 1.0);
    CHECK(moved.take_in(event(Event::move, 3.0)));
    CHECK(moved.pointer->x == 3.0);
    CHECK(moved.pointer->panned == 4.0);
    CHECK(moved.pointer->wheel == 2.0);
    for (int many = 0; many < 100'000; ++many)
      moved.take_in(event(Event::move));
    CHECK(moved.pointer->panned == PointerInput::max_number);
    for (const Event kind : {Event::down, Event::drag, Event::up, Event::size, Event::leave})
      CHECK_FALSE(moved.take_in(event(kind)));
    CHECK_FALSE(moved.take_in(event(Event::move, 3.0, "curve")));
    CHECK_FALSE(moved.take_in(FormInput{"keys", "12"}));
    FormInput pressed = event(Event::down), slid{"speed", "1"}, button{"Play", ""};
    CHECK_FALSE(pressed.take_in(event(Event::down)));
    CHECK_FALSE(pressed.take_in(FormInput{"keys", ""}));
    CHECK(slid.take_in(FormInput{"speed", "2"}));
    CHECK(slid.value == "2");
    CHECK_FALSE(slid.take_in(FormInput{"speed", "3", FormKind::run}));
    CHECK_FALSE(button.take_in(FormInput{"Play", ""}));
  }
}

} // namespace client_commands_test
