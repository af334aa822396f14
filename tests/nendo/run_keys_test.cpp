#include <fstream>
#include <initializer_list>
#include <regex>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "cli/output_place.hpp"
#include "support/eventually.hpp"
#include "support/program.hpp"
#include "support/terminal_program.hpp"

namespace run_keys_test {

using namespace nendo;
using nendo::test::TemporaryFolder;
using nendo::test::TerminalProgram;
using nendo::test::VtScreen;

TEST_SUITE("run_keys") {
  TEST_CASE("saved shapes get numbers before their ending") {
    CHECK(cli::numbered("a/shape.obj", 2) == "a/shape-2.obj");
    CHECK(cli::numbered("shape.of.clay.ply", 10) == "shape.of.clay-10.ply");
  }

  TEST_CASE("keys release, grab, keep, undo, save and end, and the terminal is given back") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "shape.obj";
    std::ofstream(folder.path() / "shape-1.obj") << "somebody else's";
    TerminalProgram program({"run", "--right", "sim:sculpt", "--out", out.string()}, 200, 24);
    REQUIRE(program.prints("keys: ? lists them"));
    REQUIRE(program.prints("ticks"));
    CHECK(program.is_raw());
    CHECK(program.press('l'));
    REQUIRE(program.prints("  released"));
    CHECK(program.press('s'));
    REQUIRE(program.prints("shape-2.obj")); // what is there stays
    CHECK(program.press('g'));
    REQUIRE(program.shows([](const VtScreen& screen) {
      const std::string& text = screen.transcript();
      return text.rfind("ticks") > text.rfind("released") + 20; // a line of progress without it
    }));
    CHECK(program.press('?'));
    CHECK(program.prints("k  Saves the most recent input as a recording"));
    CHECK(program.press('r'));
    CHECK(program.prints("There is nothing to redo."));
    CHECK(program.press('.'));
    CHECK(program.prints("There is no recording to mark; begin one with t."));
    CHECK(program.press('B')); // is nothing
    CHECK(program.press('c'));
    CHECK(program.press('u'));
    CHECK(program.press('q'));
    CHECK(program.wait() == 0);
    const std::string& text = program.screen().transcript();
    CAPTURE(text);
    CHECK(text.find("1 grabs, 1 undone") != std::string::npos);
    CHECK(program.is_restored());
    CHECK(deform::read_mesh(out));
    const auto saved = deform::read_mesh(folder.path() / "shape-2.obj");
    REQUIRE(saved);
    CHECK(saved->vertices.cols() == deform::read_mesh(out)->vertices.cols());
  }

  TEST_CASE(
      "keys change settings, record and reset while the loop runs, and say what is in effect") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "shape.obj";
    TerminalProgram program({"run", "--right", "sim:sculpt", "--out", out.string()}, 200, 24);
    REQUIRE(program.prints("keys: "));
    REQUIRE(program.prints("ticks"));
    CHECK(program.press('t'));
    REQUIRE(
        test::eventually([&] { return std::filesystem::exists(folder.path() / "shape.nendo"); }));
    CHECK(program.press(']'));
    CHECK(program.prints("type1, wendland-c2, never folds, radius 17.6 cm"));
    CHECK(program.press('['));
    CHECK(program.press('['));
    CHECK(program.prints("radius 14.5 cm"));
    CHECK(program.press('m'));
    CHECK(program.press('n'));
    CHECK(program.prints("type2, wendland-c4, never folds, radius 14.5 cm"));
    CHECK(program.press('i'));
    CHECK(program.prints("type2, wendland-c4, may fold"));
    CHECK(program.press('x'));
    CHECK(program.press('u'));
    CHECK(program.press('t'));
    CHECK(program.press('q'));
    CHECK(program.wait() == 0);
    CHECK(program.prints(" s, type2, wendland-c4")); // of the summary: the last counts, too
    const auto info =
        test::nendo({"recording", "info", "--json", (folder.path() / "shape.nendo").string()});
    REQUIRE(info.exit_code == 0);
    const auto report = nlohmann::json::parse(info.out);
    CHECK(report["whole"] == true);
    CHECK(report["loop"]["settings_changes"].get<int>() >= 1); // quick ones are taken together
    CHECK(report["loop"]["requests"]["reset"] == 1);
    CHECK(report["loop"]["requests"]["undo"] == 1);
    CHECK(test::nendo({"replay", (folder.path() / "shape.nendo").string(), "--out",
                       (folder.path() / "again.obj").string()})
              .exit_code == 0);
  }

  TEST_CASE("the line of progress stays within the terminal's width, and keeps its marks") {
    for (const unsigned short columns : std::initializer_list<unsigned short>{80, 44}) {
      CAPTURE(columns);
      const TemporaryFolder folder;
      TerminalProgram program({"run", "--left", "sim:sculpt", "--right", "sim:sculpt", "--duration",
                               "1000s", "--out", (folder.path() / "shape.obj").string()},
                              columns, 24);
      REQUIRE(program.prints(" left"));
      CHECK(program.press('l'));
      if (columns == 80) REQUIRE(program.prints("  released"));
      CHECK(program.press('q'));
      CHECK(program.wait() == 0);
      const std::string& all = program.screen().transcript();
      const std::string progress = all.substr(0, all.find("nendo run:"));
      const std::regex begin(
          R"(  [0-9]+\.[0-9]( of 1000\.0)? s  )"); // the transcript has no carriage returns
      int seen = 0;
      for (std::sregex_iterator at(progress.begin(), progress.end(), begin), end; at != end;) {
        const auto first = static_cast<std::size_t>(at->position());
        const std::size_t next =
            ++at == end ? progress.size() : static_cast<std::size_t>(at->position());
        std::string line = progress.substr(first, next - first);
        line = line.substr(0, line.find('\n'));
        ++seen;
        CAPTURE(line);
        CHECK(line.size() < columns); // the last column stays free
        CHECK(line.find(" left") != std::string::npos);
      }
      CHECK(seen > 0);
    }
  }

  TEST_CASE("where no key can come none is spoken of") {
    const TemporaryFolder folder;
    const auto done = nendo::test::nendo({"run", "--right", "sim", "--duration", "0.2", "--out",
                                          (folder.path() / "shape.obj").string()});
    CHECK(done.exit_code == 0);
    CHECK(done.err.find("keys") == std::string::npos);
  }
}

} // namespace run_keys_test
