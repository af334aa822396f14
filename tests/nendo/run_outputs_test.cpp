#include <doctest/doctest.h>

#include "support/json_lines.hpp"
#include "support/memory_screen.hpp"
#include "support/program.hpp"
#include "support/restraint.hpp"

namespace run_outputs_test {

using namespace nendo;
using nendo::test::is_one_line_about;
using nendo::test::TemporaryFolder;

TEST_SUITE("run_outputs") {
  TEST_CASE("outputs that are one file are refused before anything is opened") {
    const TemporaryFolder folder;
    const std::string one = (folder.path() / "a.obj").string();
    const std::string same = (folder.path() / "." / "a.obj").string();
    const auto done = nendo::test::nendo(
        {"run", "--right", "sim", "--duration", "1", "--out", one, "--record", same});
    CHECK(done.exit_code == 2);
    CHECK(is_one_line_about(done.err, "--record"));
    CHECK(std::filesystem::is_empty(folder.path()));
  }

  TEST_CASE(
      "the window's last picture is there, whatever ended the run, or its absence is an error") {
    const nendo::test::MemoryScreen screen;
    // Mesa's own memory is not for our sanitizers, in a child either.
    if (!screen.is_there() || !nendo::test::restraint_is_counted) return;
    const TemporaryFolder folder;
    const auto run = [&](const char* frames, const std::string& picture) {
      return nendo::test::nendo({"view", "--right", "sim", "--duration", "2", "--frames", frames,
                                 "--screenshot", picture, "--out",
                                 (folder.path() / "shape.ply").string()});
    };
    for (const char* frames : {"2", "100000"}) {
      const auto picture = folder.path() / (std::string(frames) + ".png");
      const auto done = run(frames, picture.string());
      CHECK(done.exit_code == 0);
      CHECK(done.out.find("\n  picture  ") != std::string::npos); // how long they took
      CHECK(std::filesystem::file_size(picture) > 1000);
    }
    const auto gone = folder.path() / "gone";
    std::filesystem::create_directory(gone);
    std::filesystem::create_symlink("/dev/full", gone / "full.png");
    const auto failed = run("2", (gone / "full.png").string());
    CHECK(failed.exit_code == 1);
    CHECK(failed.err.find("full") != std::string::npos);
  }

  TEST_CASE("the model itself is no output without --force, and what is odd about it is reported") {
    const TemporaryFolder folder;
    const auto model = (folder.path() / "m.obj").string();
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    nendo::test::write_file(model, text);
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> all{"run", "--right", "sim", "--duration", "0.2", "--mesh", model};
      all.insert(all.end(), more.begin(), more.end());
      return nendo::test::nendo(all);
    };
    const auto refused = run({"--out", model});
    CHECK(refused.exit_code == 2);
    CHECK(is_one_line_about(refused.err, "--force"));
    CHECK(nendo::test::contents(model) == text);
    CHECK(run({"--out", model, "--force"}).exit_code == 0);
    CHECK(nendo::test::contents(model) != text);
    const auto out = (folder.path() / "o.obj").string();
    CHECK(run({"--out", out, "--radius", "100"}).err.find("reaches all") != std::string::npos);
    CHECK(run({"--out", out, "--radius", "0.5"}).err.find("reaches all") == std::string::npos);
    nendo::test::write_file(model, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    CHECK(run({"--out", out}).err.find("m.obj: has no faces") != std::string::npos);
  }

  TEST_CASE("names that are no UTF-8 do not end the program, and its JSON stays JSON") {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "sh\xff"
                                             "ape.ply")
                                .string();
    const auto done = nendo::test::nendo(
        {"run", "--right", "sim:wave", "--duration", "0.3", "--json", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    CHECK(nendo::test::last_object(done)["result"].get<std::string>().ends_with("sh\xef\xbf\xbd"
                                                                                "ape.ply"));
    CHECK(std::filesystem::exists(out));
  }
}

} // namespace run_outputs_test
