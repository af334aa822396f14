// A person before `nendo view`: real keys in a real window, on a screen that exists in memory
// alone.

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "support/eventually.hpp"
#include "support/memory_screen.hpp"
#include "support/program.hpp"
#include "support/restraint.hpp"
#include "support/shell.hpp"
#include "support/test_meshes.hpp"

namespace view_command_test {

using namespace nendo;

namespace {

/// Writes a ball to a file, and returns it as it stands there.
deform::Mesh with_file(const std::string& path) {
  REQUIRE(deform::write_mesh(path, test::sphere(24, 48, 1.0)));
  const auto read = deform::read_mesh(path);
  REQUIRE(read);
  return *read;
}

/// Presses keys in the window of a run, by xdotool, and has the shape saved to see what they did.
struct Person {
  test::TemporaryFolder folder;
  deform::Mesh ball = with_file(at("ball.ply"));
  test::Program program{{"view", at("ball.ply"), "--left", "sim:sculpt?seed=3", "--right",
                         "sim:sculpt?seed=3", "--record", at("take.nendo"), "--out", at("clay.ply"),
                         "--json"}};
  int saved = 0;

  std::string at(const std::string& name) const { return (folder.path() / name).string(); }
  static bool does(const std::string& words) {
    return test::shell("xdotool " + words).exit_code == 0;
  }
  void come() const {
    CAPTURE(program.err_so_far());
    // A small window is drawn soon, also without a graphics card.
    REQUIRE(test::eventually([] { return does("search --name Nendo windowsize 420 320"); }));
    REQUIRE(does("mousemove 340 160")); // keys go to the window under the mouse
  }
  /// Waits until it has had an effect: commands are obeyed in their order.
  deform::Points press(const std::string& keys) {
    REQUIRE(does("key --delay 30 " + keys + " s"));
    const std::string file = at("clay-" + std::to_string(++saved) + ".ply");
    deform::Points shape;
    REQUIRE(test::eventually([&] {
      const auto read = deform::read_mesh(file);
      if (read) shape = read->vertices;
      return bool(read);
    }));
    return shape;
  }
};

struct Pixel {
  int x = 0, y = 0;
};

/// Paints a mask in the middle of the model.
bool paints(const Person& person) {
  return person.does("key --delay 60 z sleep 0.3 mousemove 340 170 mousedown 1 sleep 0.3 "
                     "mousemove 344 174 sleep 0.3 mouseup 1 sleep 0.3 key --delay 60 z sleep 0.3");
}

/// Makes a puppet of the calf, which has none yet, with fingers that never rest.
struct Maker {
  test::TemporaryFolder folder;
  std::string model = copied_model();
  test::Program program{{"view", model, "--puppet", at("spot.puppet.toml"), "--left", "sim:faces",
                         "--right", "sim:faces", "--record", at("take.nendo"), "--out",
                         at("clay.ply")}};

  std::string at(const std::string& name) const { return (folder.path() / name).string(); }
  std::string copied_model() const {
    std::filesystem::copy_file(NENDO_MODELS "/spot.obj", at("spot.obj"));
    return at("spot.obj");
  }
  static std::string words(const Pixel& pixel) {
    return "mousemove " + std::to_string(pixel.x) + " " + std::to_string(pixel.y) + " sleep 0.15 ";
  }
  void come() const {
    CAPTURE(program.err_so_far());
    REQUIRE(
        test::eventually([] { return Person::does("search --name Nendo windowsize 640 440"); }));
    REQUIRE(Person::does(words({455, 170})));
  }
  /// Saves the puppet, and returns how many functions it has; 0: there is no file yet.
  int saved_functions() const {
    Person::does("key S sleep 0.4");
    const std::string text = test::contents(at("spot.puppet.toml"));
    int count = 0;
    for (auto found = text.find("[functions."); found != std::string::npos;
         found = text.find("[functions.", found + 1))
      ++count;
    return count;
  }
  /// Clicks the first of the places that is one of the model, and waits until a finger has bent.
  Pixel place_point(int number, const std::vector<Pixel>& places) const {
    for (const Pixel& place : places) {
      REQUIRE(Person::does(words(place) + "click 1"));
      for (int wait = 0; wait < 90; ++wait)
        if (saved_functions() == number) return place;
    }
    FAIL("no click has made a point");
    return {};
  }
  void drag(const Pixel& from, const Pixel& to) const {
    REQUIRE(
        Person::does(words(from) + "mousedown 1 sleep 0.15 " + words(to) + "mouseup 1 sleep 0.15"));
  }
};

double gap(const deform::Points& a, const deform::Points& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

} // namespace

TEST_SUITE("view_command") {
  TEST_CASE("the screen continues when its last client leaves") {
    const test::MemoryScreen screen;
    if (!screen.is_there() || !Person::does("version")) return;
    // A screen that restarts puts the pointer in its middle, and refuses a window meanwhile.
    REQUIRE(Person::does("mousemove 11 12"));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const auto report = test::shell("xdotool getmouselocation");
    CHECK(report.out.find("x:11 y:12") == 0);
  }

  TEST_CASE("a person shapes, changes radius, kernel and mode, shapes on, undoes all of it and "
            "redoes it, "
            "and the recording replays to the same bytes") {
    const test::MemoryScreen screen;
    // Mesa's own memory is not for our sanitizers, in a child either.
    if (!screen.is_there() || !test::restraint_is_counted) return;
    if (!Person::does("version")) {
      MESSAGE("no xdotool here, so nobody presses keys; tools/setup test installs it");
      return;
    }
    Person person;
    person.come();
    const deform::Points& loaded = person.ball.vertices;
    person.press("c bracketright bracketright");
    person.press("c n");
    person.press("m");
    REQUIRE(paints(person));
    person.press("y");
    person.press("bracketleft c");
    person.press("l");
    const deform::Points shaped = person.press("c"); // nothing is held: it stays as it is
    CHECK(gap(shaped, loaded) > 1e-2);
    const std::string far = "u u u u u u u u u u u u u u u u";
    person.press(far);
    // An undo of settings takes a picture or two until the next is done.
    CHECK(test::eventually([&] { return gap(person.press("u"), loaded) == 0.0; }));
    person.press("r r r r r r r r r r r r r r r r");
    CHECK(test::eventually([&] { return gap(person.press("r"), shaped) < 1e-5; }));
    REQUIRE(Person::does("key q"));
    const auto finished = person.program.wait();
    REQUIRE(finished.exit_code == 0);
    const std::string last = finished.out.substr(finished.out.rfind("{\"event\":\"summary\""));
    const auto summary = nlohmann::json::parse(last);
    CHECK(summary["mode"] == "type2");
    CHECK(summary["kernel"] == "wendland-c4");
    CHECK(summary["undos"].get<int>() >= 5); // changes within a second are one step
    CHECK(summary["redos"].get<int>() >= 5);
    const auto report = test::nendo({"recording", "info", person.at("take.nendo"), "--json"});
    // The mask, symmetry, and both ways of each by undo and redo.
    CHECK(nlohmann::json::parse(report.out)["loop"]["puppet_changes"].get<int>() >= 6);
    const auto replayed =
        test::nendo({"replay", person.at("take.nendo"), "--out", person.at("again.ply")});
    REQUIRE(replayed.exit_code == 0);
    CHECK(test::contents(person.at("again.ply")) == test::contents(person.at("clay.ply")));
  }

  TEST_CASE("a person makes a puppet by clicks and drags, saves it, and the recording replays to "
            "the same bytes") {
    const test::MemoryScreen screen;
    if (!screen.is_there() || !test::restraint_is_counted || !Person::does("version")) return;
    Maker maker;
    maker.come();
    const Pixel first = maker.place_point(1, {{455, 110}, {455, 150}, {475, 190}, {440, 190}});
    maker.place_point(
        2, {{first.x + 30, first.y + 20}, {first.x - 30, first.y + 20}, {first.x, first.y + 40}});
    const std::string before = test::contents(maker.at("spot.puppet.toml"));
    // The function that moves the first point gets another way.
    maker.drag(first, {first.x + 8, first.y - 8});
    REQUIRE(Person::does("key S")); // once: where pictures come late, keys wait for them
    CHECK(test::eventually([&] { return test::contents(maker.at("spot.puppet.toml")) != before; }));
    CHECK(before.find("model = \"spot.obj\"") != std::string::npos);
    REQUIRE(Person::does("key --delay 60 Tab"));
    std::this_thread::sleep_for(std::chrono::seconds(1)); // the fingers play it
    REQUIRE(Person::does("key --delay 60 Tab Y"));        // mirrored, and back
    REQUIRE(Person::does("key --delay 60 u Tab"));
    std::this_thread::sleep_for(std::chrono::seconds(1));
    REQUIRE(Person::does("key q"));
    const auto finished = maker.program.wait(std::chrono::seconds(180));
    CAPTURE(finished.err);
    REQUIRE(finished.exit_code == 0);
    const auto checked = test::nendo({"puppet", "check", maker.at("spot.puppet.toml")});
    CHECK_MESSAGE(checked.exit_code == 0, checked.err);
    const auto shown = test::nendo({"puppet", "show", maker.at("spot.puppet.toml")});
    CHECK_MESSAGE(shown.out.find("2 points, 2 functions") != std::string::npos, shown.out);
    const auto replayed =
        test::nendo({"replay", maker.at("take.nendo"), "--out", maker.at("again.ply")});
    REQUIRE_MESSAGE(replayed.exit_code == 0, replayed.err);
    CHECK(test::contents(maker.at("again.ply")) == test::contents(maker.at("clay.ply")));
  }
}

} // namespace view_command_test
