#include <fstream>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "cli/output_place.hpp"
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

  TEST_CASE("keys let go, take hold, keep, undo, save and end, and the terminal is given back") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "shape.obj";
    std::ofstream(folder.path() / "shape-1.obj") << "somebody else's";
    TerminalProgram program({"run", "--right", "sim:sculpt", "--out", out.string()}, 200, 24);
    REQUIRE(program.tells("keys: g lets go"));
    REQUIRE(program.tells("ticks"));
    CHECK(program.is_raw());
    CHECK(program.press('g'));
    REQUIRE(program.tells("  let go"));
    CHECK(program.press('s'));
    REQUIRE(program.tells("shape-2.obj")); // what is there stays
    CHECK(program.press('g'));
    REQUIRE(program.sees([](const VtScreen& screen) {
      const std::string& text = screen.transcript();
      return text.rfind("ticks") > text.rfind("let go") + 20; // a line of progress without it
    }));
    CHECK(program.press('?')); // is nothing
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

  TEST_CASE("where no key can come none is spoken of") {
    const TemporaryFolder folder;
    const auto done = nendo::test::nendo({"run", "--right", "sim", "--duration", "0.2", "--out",
                                          (folder.path() / "shape.obj").string()});
    CHECK(done.exit_code == 0);
    CHECK(done.err.find("keys") == std::string::npos);
  }
}

} // namespace run_keys_test
