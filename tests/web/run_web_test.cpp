// `nendo run --web`, from outside.

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "following_client.hpp"
#include "support/eventually.hpp"
#include "support/program.hpp"
#include "support/terminal_program.hpp"
#include "web_client.hpp"

namespace run_web_test {

using namespace nendo;
using nendo::test::FollowingClient;
using nendo::test::WebClient;
namespace fs = std::filesystem;

namespace {

struct Address {
  std::uint16_t port = 0;
  std::string token;
};

/// The address in the program's output so far; port 0 if it is not there yet.
Address address_in(const std::string& output) {
  const std::string before = "http://127.0.0.1:";
  const auto at = output.find(before);
  if (at == std::string::npos || output.find('\n', at) == std::string::npos) return {};
  const auto mark = output.find("/#", at) + 2;
  return {static_cast<std::uint16_t>(std::stoi(output.substr(at + before.size()))),
          output.substr(mark, output.find_first_of("\r\n", at) - mark)};
}

Address address_of(const test::Program& program) {
  Address address;
  test::eventually([&] {
    address = address_in(program.err_so_far());
    return address.port != 0;
  });
  return address;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Connects as the page does: gets the model as soon as there is one, and opens a WebSocket.
struct Browser {
  Address address;
  std::optional<FollowingClient> follower;
  std::optional<WebClient> client;

  void connect() {
    test::Answer model;
    while (model.status != 200 && model.status != 403) {
      WebClient asks(address.port, address.token);
      model = asks.get(asks.with_token("/model"));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    REQUIRE(model.status == 200);
    follower.emplace(bytes_of(model.body));
    REQUIRE(follower->good);
    client.emplace(address.port, address.token);
    REQUIRE(client->open_socket() == 101);
  }
  void follow_until(const std::function<bool()>& is_so) {
    while (!is_so()) {
      const auto frame = client->next();
      REQUIRE(frame);
      if (frame->opcode == 2) REQUIRE(follower->take(frame->payload));
    }
  }
  /// Sends a command when the run has continued for a while, and follows until it is executed.
  void ask(const std::string& command, const std::function<bool(const FollowingClient&)>& done) {
    const int then = follower->updates + 30;
    follow_until([&] { return follower->follows() && follower->updates > then; });
    REQUIRE_FALSE(done(*follower));
    REQUIRE(client->send_text(command));
    follow_until([&] { return done(*follower); });
  }
};

constexpr const char* no_model = "f 1 2 3 4 5\nv nan nan";
constexpr const char* tetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/// A studio on a page, which keeps its files in a folder, and a browser that shows it.
struct Studio {
  test::Program program;
  Address address;
  Browser browser;

  explicit Studio(const fs::path& folder, const std::string& left = "sim:rest")
      : program(started_in(folder, left)), address(address_of(program)), browser{address, {}, {}} {
    REQUIRE(address.token.size() == 32);
    browser.connect();
  }
  /// Waits for a form with these words; comes again after another model.
  bool sees(const std::string& words) { return waits_for(words, true); }
  /// Waits for one without them.
  bool sees_no(const std::string& words) { return waits_for(words, false); }
  bool waits_for(const std::string& words, bool is_there) {
    while (const auto frame = browser.client->next()) {
      if (frame->opcode == 8) browser.connect();
      const std::string text(reinterpret_cast<const char*>(frame->payload.data()),
                             frame->payload.size());
      const bool is_screen = text[0] == 12 && text.find("\"screen\"") != std::string::npos;
      if (is_screen && is_there == (text.find(words) != std::string::npos)) return true;
    }
    return false;
  }
  /// Waits for that screen of the run that is shown; not of another one.
  bool leads_to(const std::string& screen) {
    while (const auto frame = browser.client->next()) {
      const std::string text(reinterpret_cast<const char*>(frame->payload.data()),
                             frame->payload.size());
      if (frame->opcode == 8 || text.find("Save the shape of") != std::string::npos) return false;
      if (text[0] == 12 && text.find("\"screen\":\"" + screen) != std::string::npos) return true;
    }
    return false;
  }
  void press(const std::string& control, const std::string& value = {}) {
    browser.client->send_text("form\t" + control + "\t" + value);
  }
  /// Sends a file, and returns the answer's status.
  int send(const std::string& name, const std::string& bytes) const {
    WebClient client(address.port, address.token);
    client.send("POST " + client.with_token("/open") + "&name=" + name +
                " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: " + std::to_string(bytes.size()) +
                "\r\n\r\n" + bytes);
    return client.answer().status;
  }
  /// Waits for another model or none, as after the end of a run.
  void comes_again() {
    CHECK(browser.client->close_code() == 1012);
    browser.connect();
  }
  /// Waits for a run with this model.
  void follows_run_of(const std::string& model) {
    CHECK(browser.client->close_code() == 1012);
    test::eventually([&] {
      browser.connect();
      return browser.follower->name == model;
    });
    REQUIRE(sees("Shaping"));
  }

private:
  static test::Program started_in(const fs::path& folder, const std::string& left) {
    const fs::path before = fs::current_path();
    fs::current_path(folder); // where the files go
    ::setenv("XDG_STATE_HOME", folder.c_str(), 1);
    struct Back {
      fs::path before;
      ~Back() {
        ::unsetenv("XDG_STATE_HOME");
        fs::current_path(before);
      }
    } const back{before};
    return test::Program({"studio", "--web", "0", "--left", left});
  }
};

} // namespace

TEST_SUITE("run_web") {
  TEST_CASE("a browser's client follows a run to the shape that it writes, and releases the model "
            "in between") {
    for (const auto* mode : {"type1", "type2"}) {
      CAPTURE(mode);
      const test::TemporaryFolder folder;
      const auto out = folder.path() / "clay.ply";
      test::Program program({"run", "--left", "sim:sculpt?seed=7", "--right", "sim:sculpt?seed=7",
                             "--mode", mode, "--web", "0", "--out", out.string()});
      const Address address = address_of(program);
      REQUIRE(address.token.size() == 32);
      CHECK(WebClient(address.port, "").get("/").status == 200);
      CHECK(WebClient(address.port, "").get("/model").status == 403);
      Browser browser{address, {}, {}};
      browser.connect();
      FollowingClient& follower = *browser.follower;
      WebClient& client = *browser.client;
      CHECK(follower.name == "moai.obj");
      bool asked = false;
      while (!asked || follower.held) {
        const auto frame = client.next();
        REQUIRE(frame);
        if (frame->opcode == 2) REQUIRE(follower.take(frame->payload));
        if (asked || follower.updates < 100) continue;
        asked = client.send_text("let go");
      }
      program.signal(SIGTERM);
      while (const auto frame = client.next())
        if (frame->opcode == 2) CHECK(follower.take(frame->payload));
      CHECK(program.wait().exit_code == 0);
      const auto written = deform::read_mesh(out);
      REQUIRE(written);
      const auto shape = follower.vertices();
      REQUIRE(written->vertices.cols() == shape.cols());
      CHECK((written->vertices - shape).cwiseAbs().maxCoeff() < 1e-5 * follower.diagonal);
      const auto rest = deform::read_mesh(NENDO_MODELS "/moai.obj");
      REQUIRE(rest);
      CHECK((rest->vertices - shape).cwiseAbs().maxCoeff() > 1e-3); // something was shaped
    }
  }

  TEST_CASE(
      "a browser's client follows a face's puppet, whose eyes and teeth follow others, to the "
      "shape that it saves, within 2e-6 of the diagonal, and has its colours") {
    const test::TemporaryFolder folder;
    const auto out = folder.path() / "face.obj";
    test::Program program({"run", "--puppet", "face", "--left", "sim:faces?seed=7", "--right",
                           "sim:faces?seed=7", "--web", "0", "--out", out.string()});
    Browser browser{address_of(program), {}, {}};
    browser.connect();
    const FollowingClient& seen = *browser.follower;
    CHECK(seen.coats.size() > 5);
    const auto rest = deform::read_mesh(NENDO_MODELS "/face.obj");
    REQUIRE(rest);
    // Between its expressions the face is at rest, and a copy of nothing would look alike.
    const auto is_shaped = [&] {
      return (rest->vertices - seen.vertices()).cwiseAbs().maxCoeff() > 1e-2 * seen.diagonal;
    };
    browser.follow_until([&] { return seen.vectors > 0 && seen.updates > 100 && is_shaped(); });
    CHECK(seen.update_bytes < 1200);
    CHECK(std::find(seen.functions.begin(), seen.functions.end(),
                    std::pair<std::string, std::string>("jawOpen", "right.thumb_flexion")) !=
          seen.functions.end());
    REQUIRE(browser.client->send_text("let go"));
    browser.follow_until([&] { return !seen.held; });
    CHECK(seen.good);
    CHECK(seen.weights == 1);
    CHECK(seen.shapes == 1);
    program.signal(SIGTERM);
    CHECK(program.wait().exit_code == 0);
    const auto written = deform::read_mesh(out);
    REQUIRE(written);
    CHECK((written->vertices - seen.vertices()).cwiseAbs().maxCoeff() < 2e-6 * seen.diagonal);
  }

  TEST_CASE(
      "a browser's client changes settings, resets, records, and moves a hand, and the loop goes "
      "on") {
    const test::TemporaryFolder folder;
    const auto out = folder.path() / "clay.ply";
    test::Program program({"run", "--left", "sim:sculpt?seed=7", "--right", "sim:sculpt?seed=7",
                           "--web", "0", "--out", out.string()});
    Browser browser{address_of(program), {}, {}};
    browser.connect();
    const FollowingClient& seen = *browser.follower;
    browser.follow_until([&] { return seen.settings_messages > 0; });
    const auto value = [&](const char* name) { return seen.settings.at(name); };
    // A fifth of the model's longest side.
    CHECK(std::stod(value("radius_m")) == doctest::Approx(0.16));
    CHECK(value("mode") == "type1");
    const std::string piece = value("piece_fraction");
    browser.ask(
        "settings mode=type2 kernel=wendland-c4 injective=true filter=one-euro "
        "radius_m=0.1,0.1,0.1,0.1,0.05 brushes=pull,none,pull,none,pull brush_strength=-0.5",
        [](const auto& now) { return now.settings.at("mode") == "type2"; });
    CHECK(value("kernel") == "wendland-c4");
    CHECK(value("brushes") == "pull,none,pull,none,pull");
    CHECK(value("brush_strength") == "-0.5");
    CHECK(value("injective") == "true");
    CHECK(value("filter") == "one-euro");
    CHECK(value("radius_m") == "0.1,0.1,0.1,0.1,0.05");
    CHECK(value("piece_fraction") == piece);
    CHECK_FALSE(seen.on.contains("take"));
    browser.ask("record", [](const auto& now) { return now.on.contains("take"); });
    CHECK(test::eventually([&] { return fs::exists(folder.path() / "clay.nendo"); }));
    const auto jumps = seen.jumps;
    browser.ask("reset", [&](const auto& now) { return now.jumps > jumps; });
    const auto rows = [&] { return seen.control("step").value("rows", nlohmann::json::array()); };
    const auto present = [&] { return seen.control("step").value("value", 0U); };
    const auto is_reset = [&] {
      return rows().size() > 1 && std::string(rows().back()["name"]).ends_with("reset");
    };
    browser.follow_until(is_reset);
    CHECK(present() + 1 == rows().size()); // the reset is the last of them
    browser.ask("undo", [&](const auto& now) { return now.jumps > jumps + 1; });
    browser.follow_until([&] { return present() + 2 == rows().size(); });
    CHECK(rows().back()["look"] == "faint");
    browser.follow_until([&] { return !seen.refusals.contains("redo"); });
    CHECK(seen.refusals.contains("keep")); // without --keep-last
    browser.ask("end recording", [](const auto& now) { return !now.on.contains("take"); });
    browser.ask("settings mode=type1 injective=false",
                [](const auto& now) { return now.settings.at("mode") == "type1"; });
    CHECK(value("injective") == "false");
    CHECK(value("kernel") == "wendland-c4"); // what is not named stays
    CHECK(value("radius_m") == "0.1,0.1,0.1,0.1,0.05");
    browser.ask("record", [](const auto& now) { return now.on.contains("take"); });
    CHECK(test::eventually([&] { return fs::exists(folder.path() / "clay-2.nendo"); }));
    CHECK(browser.client->send_text("wrist left -0.5 0.25 0.125 0 0 0 1"));
    const Eigen::Vector3d there(-0.5, 0.25, 0.125);
    browser.follow_until([&] { return (browser.follower->joints[0][1] - there).norm() < 1e-6; });
    CHECK(browser.follower->forearms[0].angularDistance(Eigen::Quaterniond::Identity()) < 2e-4);
    program.signal(SIGTERM);
    CHECK(program.wait().exit_code == 0);
  }

  TEST_CASE(
      "a browser's client has the shape saved and the recording kept, and a report says where") {
    const test::TemporaryFolder folder;
    const auto out = folder.path() / "clay.ply";
    test::Program program({"run", "--left", "sim:sculpt?seed=7", "--right", "sim:sculpt?seed=7",
                           "--web", "0", "--keep-last", "10s", "--out", out.string()});
    Browser browser{address_of(program), {}, {}};
    browser.connect();
    const auto expect_report = [&](const std::string& command, const std::string& what) {
      REQUIRE(browser.client->send_text(command));
      browser.follow_until(
          [&] { return browser.follower->report.find(what) != std::string::npos; });
    };
    browser.follow_until([&] { return browser.follower->updates > 60; });
    const auto saved = folder.path() / "clay-1.ply";
    expect_report("redo", "nothing to redo");
    CHECK(browser.follower->is_error);
    expect_report("save", "saved as " + saved.string());
    CHECK_FALSE(browser.follower->is_error);
    const auto shape = deform::read_mesh(saved);
    REQUIRE(shape);
    CHECK(shape->vertices.cols() == static_cast<Eigen::Index>(browser.follower->order.size()));
    expect_report("keep", "is being kept");
    CHECK(test::eventually([&] {
      return std::any_of(fs::directory_iterator(folder.path()), fs::directory_iterator(),
                         [](const auto& file) { return file.path().extension() == ".nendo"; });
    }));
    program.signal(SIGTERM);
    CHECK(program.wait().exit_code == 0);
    CHECK(fs::exists(out));
  }

  TEST_CASE("a browser's client gets a report of files that keys in the terminal save") {
    const test::TemporaryFolder folder;
    const auto out = folder.path() / "clay.ply";
    test::TerminalProgram program({"run", "--left", "sim:sculpt?seed=7", "--web", "0",
                                   "--keep-last", "10s", "--out", out.string()},
                                  200, 24);
    Address address;
    REQUIRE(program.shows([&](const test::VtScreen& screen) {
      address = address_in(screen.transcript());
      return address.port != 0;
    }));
    Browser browser{address, {}, {}};
    browser.connect();
    for (const auto& answer : {std::pair{'s', "clay-1.ply"}, {'k', "is being kept"}}) {
      const std::string what = answer.second;
      REQUIRE(program.press(answer.first));
      browser.follow_until(
          [&] { return browser.follower->report.find(what) != std::string::npos; });
      CHECK(program.prints(what));
    }
    CHECK(program.press('q'));
    CHECK(program.wait() == 0);
  }

  TEST_CASE("a studio on a page begins runs, opens files that are sent to it, and refuses others") {
    const test::TemporaryFolder folder;
    Studio studio(folder.path());
    REQUIRE(studio.sees("With this model"));
    CHECK(studio.browser.follower->name.empty());
    for (const auto& [tab, words] : {std::pair{"Timeline", "Record while the hands shape"},
                                     {"Calibration", "Calibrate the left hand"},
                                     {"Timeline", "Record while the hands shape"},
                                     {"Start", "With this model"}}) {
      CAPTURE(words);
      studio.press(tab);
      REQUIRE(studio.sees(words));
    }
    studio.press("Head");
    studio.press("Puppet#1"); // the first is the tab
    REQUIRE(studio.sees("head.obj: has no puppet yet"));
    studio.press("Close");
    studio.press("Head"); // no more
    CHECK(studio.send("hostile.obj", no_model) == 200);
    REQUIRE(studio.sees("hostile.obj"));
    CHECK_FALSE(fs::exists(folder.path() / "hostile.obj"));
    studio.press("Close");
    CHECK(studio.send("program.sh", "rm") == 200);
    REQUIRE(studio.sees("program.sh: the studio opens"));
    studio.press("Close");
    studio.press("Open a file...");
    studio.press("file name", "/etc/passwd");
    studio.press("Open");
    REQUIRE(studio.sees("/etc/passwd: the studio opens"));
    studio.press("Close");
    CHECK(studio.send("scan.obj", tetrahedron) == 200);
    studio.follows_run_of("scan.obj");
    CHECK(studio.send("during.obj", tetrahedron) == 200);
    studio.press("Discard"); // if the hands have moved the model
    studio.follows_run_of("during.obj");
    studio.press("Start");
    studio.press("Discard");
    studio.comes_again();
    REQUIRE(studio.sees("With this model"));
    studio.program.signal(SIGTERM);
    CHECK(studio.program.wait().exit_code == 0);
  }

  TEST_CASE("the tab of a run leads back to it from the timeline, and another tab to another run") {
    const test::TemporaryFolder folder;
    Studio studio(folder.path());
    REQUIRE(studio.sees("With this model"));
    studio.press("Puppet");
    studio.follows_run_of("face.obj");
    studio.press("Timeline");
    REQUIRE(studio.leads_to("timeline"));
    studio.press("Puppet");
    REQUIRE(studio.leads_to("shaping")); // the page's word for runs
    studio.press("Timeline");
    REQUIRE(studio.leads_to("timeline"));
    studio.press("Shaping");
    CHECK_FALSE(studio.leads_to("shaping"));
    studio.press("Discard"); // if the puppet has moved the face
    REQUIRE(test::eventually([&] {
      studio.browser.connect();
      return studio.browser.follower->name == "moai.obj";
    }));
    studio.press("Timeline");
    REQUIRE(studio.leads_to("timeline"));
    studio.press("Shaping");
    REQUIRE(studio.leads_to("shaping"));
  }

  TEST_CASE("a studio on a page asks before the poses of a calibration are lost") {
    const test::TemporaryFolder folder;
    Studio studio(folder.path());
    REQUIRE(studio.sees("With this model"));
    studio.press("Calibration");
    REQUIRE(studio.sees("your name"));
    studio.press("Start"); // nothing is lost yet
    REQUIRE(studio.sees("With this model"));
    studio.press("Calibration");
    REQUIRE(studio.sees("Choose who you are, and press Start."));
    studio.press("your name", "anna");
    studio.press("Start#1"); // the first is the tab
    REQUIRE(studio.sees("First, show how far each joint goes."));
    studio.press("Begin");
    REQUIRE(studio.sees("Taken. Now take this pose."));
    CHECK(studio.send("scan.obj", tetrahedron) == 200);
    REQUIRE(studio.sees("Discard the poses?"));
    CHECK(fs::exists(folder.path() / "scan.obj"));
    studio.press("Stay");
    REQUIRE(studio.sees_no("Discard the poses?"));
    CHECK_FALSE(fs::exists(folder.path() / "scan.obj"));
    studio.press("Start");
    REQUIRE(studio.sees("Discard the poses?"));
    studio.press("Discard");
    REQUIRE(studio.sees("With this model"));
  }

  TEST_CASE("a file that was sent during a run stays only if it is opened") {
    const test::TemporaryFolder folder;
    Studio studio(folder.path(), "sim:sculpt?seed=7");
    const auto stays = [&](const char* name) { return fs::exists(folder.path() / name); };
    REQUIRE(studio.sees("With this model"));
    CHECK(studio.send("scan.obj", tetrahedron) == 200);
    studio.follows_run_of("scan.obj");
    REQUIRE(studio.sees("scan.obj *"));         // the hands have moved it,
    studio.browser.client->send_text("commit"); // and it stays so
    CHECK(studio.send("unwanted.obj", tetrahedron) == 200);
    REQUIRE(studio.sees("Save the shape of"));
    CHECK(stays("unwanted.obj"));
    studio.press("Stay");
    REQUIRE(studio.sees_no("Save the shape of"));
    CHECK_FALSE(stays("unwanted.obj"));
    CHECK(studio.send("forgotten.obj", tetrahedron) == 200);
    CHECK(test::eventually([&] { return studio.send("hostile.obj", no_model) == 200; }));
    REQUIRE(studio.sees("Save the shape of"));
    studio.press("Discard");
    studio.comes_again();
    REQUIRE(studio.sees("hostile.obj"));
    CHECK_FALSE(stays("hostile.obj"));
    CHECK_FALSE(stays("forgotten.obj"));
    CHECK(stays("scan.obj"));
  }

  TEST_CASE("a recording that was sent to the studio stays when another file fails") {
    const test::TemporaryFolder folder;
    const auto take = folder.path() / "take.nendo";
    REQUIRE(test::nendo({"run", "--left", "sim", "--duration", "0.5s", "--record", take.string(),
                         "--out", (folder.path() / "out.ply").string()})
                .exit_code == 0);
    const std::string bytes = test::contents(take);
    Studio studio(folder.path());
    REQUIRE(studio.sees("With this model"));
    CHECK(studio.send("sent.nendo", bytes) == 200);
    REQUIRE(studio.sees("Where the play head is"));
    CHECK(studio.send("program.sh", "rm") == 200);
    REQUIRE(studio.sees("program.sh: the studio opens"));
    CHECK(fs::exists(folder.path() / "sent.nendo"));
    studio.press("Close");
    studio.press("Start");
    REQUIRE(studio.sees("With this model"));
    studio.press("Open a file...");
    studio.press("file name", "nothing.obj");
    studio.press("Open");
    REQUIRE(studio.sees("nothing.obj: there is no such file"));
    CHECK(fs::exists(folder.path() / "sent.nendo"));
  }

  TEST_CASE("an address that is none, or not this machine's, is one line before anything begins") {
    const auto nonsense = test::nendo({"run", "--left", "sim", "--web", "localhost:80"});
    CHECK(nonsense.exit_code == 2);
    CHECK(test::is_one_line_about(nonsense.err, "--web localhost:80"));
    const auto elsewhere = test::nendo({"run", "--left", "sim", "--web", "192.0.2.1:8080"});
    CHECK(elsewhere.exit_code == 1);
    CHECK(test::is_one_line_about(elsewhere.err, "is not of this machine"));
    const auto dark = test::nendo({"studio", "--web", "0", "--theme", "dark"});
    CHECK(dark.exit_code == 2);
    CHECK(test::is_one_line_about(dark.err, "leave out --web"));
  }
}

} // namespace run_web_test
