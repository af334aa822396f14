// What messages advise, done as they say. The commands are run by a shell, as somebody who copies
// them from the message does. tools/check-advice checks that those of all other messages exist.

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/nasty_meshes.hpp"
#include "support/shell.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace advice_test {

using namespace nendo;

namespace {

/// A folder with models, recordings and a table, and a shell in it that knows nendo.
struct Fixture {
  test::TemporaryFolder folder;

  Fixture() {
    std::filesystem::create_directory(folder.path() / "bin");
    std::filesystem::create_symlink(NENDO_PROGRAM, folder.path() / "bin" / "nendo");
    deform::Mesh cube = test::cube_of_cells(2);
    save("ball.obj", cube);
    cube.face_starts.pop_back();
    cube.face_corners.resize(cube.face_starts.back());
    save("my open.obj", cube);
    test::write_file(folder.path() / "table.csv", "index_mcp\n100\n110\n120\n");
  }
  void save(const std::string& name, const deform::Mesh& mesh) const {
    REQUIRE(deform::write_mesh(folder.path() / name, mesh));
  }
  test::Spoken type(const std::string& command) const {
    const std::string place = folder.path().string();
    return test::shell("cd " + place + "; export PATH=" + place +
                       "/bin:$PATH XDG_CONFIG_HOME=" + place + "; " + command);
  }
  void done(const std::string& command) const {
    const auto spoken = type(command);
    CAPTURE(command);
    REQUIRE_MESSAGE(spoken.exit_code == 0, spoken.out);
  }
};

/// The text between the first `begin` and the next `end`; empty if there is none.
std::string between(const std::string& text, std::string_view begin, std::string_view end) {
  const auto from = text.find(begin);
  if (from == std::string::npos) return {};
  const auto to = text.find(end, from + begin.size());
  return text.substr(from + begin.size(), to - from - begin.size());
}

std::string filled(std::string command,
                   const std::vector<std::pair<std::string, std::string>>& places) {
  for (const auto& [name, value] : places)
    if (const auto at = command.find(name); at != std::string::npos)
      command.replace(at, name.size(), value);
  return command;
}

constexpr std::string_view run = "nendo run --left sim --right sim --duration 0.1 --out out.obj ";

} // namespace

TEST_SUITE("advice") {
  TEST_CASE_FIXTURE(Fixture, "commands in messages do what the message promises") {
    struct Case {
      std::string refused;
      std::vector<std::pair<std::string, std::string>> places; ///< of the advised command
      std::string again; ///< what works then; empty: the advised command is all
    };
    done("nendo record sim --duration 0.3 --out gloves.nendo");
    done("nendo record 'sim?hand=left' --duration 0.3 --out left.nendo");
    const std::string cut = "nendo cut --plane 0.1,0.1,0.1,1,2,3 --out part-%d.obj ";
    for (const Case& made :
         {Case{cut + "'my open.obj'", {{"OUT", "a.obj"}}, cut + "a.obj"},
          Case{"nendo join ball.obj 'my open.obj' --out j.obj",
               {{"IN", "'my open.obj'"}, {"OUT", "b.obj"}},
               "nendo cut b.obj --plane 0.1,0.1,0.1,1,2,3 --out part-%d.obj"},
          Case{std::string(run) + "--refine 100 'my open.obj'",
               {{"IN", "'my open.obj'"}, {"OUT", "c.obj"}},
               std::string(run) + "--refine 100 c.obj"},
          Case{"nendo replay gloves.nendo", {{"FILE", "gloves.nendo"}}, ""},
          Case{"nendo replay left.nendo", {{"FILE", "left.nendo"}}, ""},
          Case{"nendo export gloves.nendo --out g.pc2", {{"FILE", "gloves.nendo"}}, ""},
          Case{"nendo info serial:/dev/no-such-port", {}, ""},
          Case{"nendo stress --compare table.csv",
               {{"--json", "--duration 0.2 --json"}, {"FILE", "report.json"}},
               "nendo stress --duration 0.2 --compare report.json"}}) {
      CAPTURE(made.refused);
      const auto refused = type(made.refused);
      CHECK(refused.exit_code != 0);
      CAPTURE(refused.out);
      const std::string advice = between(refused.out, "`", "`");
      REQUIRE(advice.starts_with("nendo "));
      done(filled(advice, made.places));
      if (!made.again.empty()) done(made.again);
    }
  }

  TEST_CASE_FIXTURE(Fixture, "an option that a message asks for is taken, and fixes it") {
    struct Case {
      std::string refused;
      std::string asked; ///< as it stands in the message
      std::string added; ///< empty: that
    };
    test::write_file(folder.path() / "masks.toml",
                     "version = 1\n[[masks]]\nat = [0.1, 0.1, 0]\nradius = 0.1\n");
    for (const Case& made :
         {Case{std::string(run) + "--filter-beta 1", "--filter one-euro", ""},
          Case{std::string(run) + "--strength 0.5", "--brush inflate", ""},
          Case{std::string(run) + "ball.obj --topology", "--refine 100000", "--refine 100"},
          Case{std::string(run) + "--puppet masks.toml", "--mask", "--mask masks.toml"},
          Case{std::string(run) + "--threads 2 --priority 5", "--priority 0", ""},
          Case{"nendo deform ball.obj --vectors v.csv --out o.obj", "--radius R", "--radius 0.3"},
          Case{"nendo cut 'my open.obj' --plane 0.1,0.1,0.1,1,2,3 --out p-%d.obj", "--repair", ""},
          Case{"nendo picture ball.obj --turntable 36 --pixels 4000x4000 --out p.png", "--numbered",
               "--pixels 64x64 --numbered"}}) {
      test::write_file(folder.path() / "v.csv", "x,y,z,dx,dy,dz\n0,0,0,0,0,0.1\n");
      CAPTURE(made.refused);
      const auto refused = type(made.refused);
      CHECK(refused.exit_code != 0);
      CAPTURE(refused.out);
      CHECK(refused.out.find(made.asked) != std::string::npos);
      const std::string added = made.added.empty() ? made.asked : made.added;
      // An option that was given already takes the advised value.
      const std::string name = added.substr(0, added.find(' '));
      std::string command = made.refused;
      if (const auto at = command.find(name + ' '); at != std::string::npos)
        command.erase(at, command.find(' ', at + name.size() + 1) - at);
      if (made.asked == "--mask") command = std::string(run);
      done(command + ' ' + added);
    }
  }

  TEST_CASE_FIXTURE(Fixture, "what is added to a glove's name is taken") {
    done("nendo record sim 'sim?hand=left' --duration 0.3 --out two.nendo");
    struct Case {
      std::string glove, asked, right;
    };
    for (const Case& made :
         {Case{"replay:table.csv", "?rate=HZ", "replay:table.csv?rate=60"},
          Case{"replay:two.nendo", "?hand=left", "replay:two.nendo?hand=left"}}) {
      const auto refused = type("nendo monitor --json --count 1 " + made.glove);
      CHECK(refused.exit_code != 0);
      CHECK(refused.out.find(made.asked) != std::string::npos);
      done("nendo monitor --json --count 1 '" + made.right + "'");
    }
  }

  TEST_CASE_FIXTURE(Fixture, "a model that was moved away is named with --mesh, by every command") {
    done(std::string(run) + "ball.obj --record take.nendo");
    done("nendo edit make take.nendo --out take.timeline.toml");
    std::filesystem::rename(folder.path() / "ball.obj", folder.path() / "moved.obj");
    for (const std::string command :
         {"nendo replay take.nendo --no-clock --out r.obj", "nendo export take.nendo --out e.pc2",
          "nendo picture take.nendo --out p.png",
          "nendo edit make take.nendo --out m.timeline.toml", "nendo edit play take.timeline.toml",
          "nendo picture take.timeline.toml --out q.png",
          "nendo export take.timeline.toml --out f.pc2",
          "nendo edit mirror take.timeline.toml --out n.timeline.toml",
          "nendo run --over take.nendo --left sim --layer left.thumb --duration 0.1 --out o.obj"}) {
      CAPTURE(command);
      const auto refused = type(command);
      CHECK(refused.exit_code != 0);
      CHECK(refused.out.find("--mesh") != std::string::npos);
      done(command + " --mesh moved.obj");
    }
  }

  TEST_CASE_FIXTURE(Fixture,
                    "the help that a wrong usage names is about the option that is missing") {
    for (const auto& [usage, option] :
         {std::pair{"nendo edit make take.nendo", "--out"},
          std::pair{"nendo picture a.obj", "--out"}, std::pair{"nendo calibration import", "FILE"},
          std::pair{"nendo edit copy t", "--hand"}}) {
      const std::string command = usage; // Clang 14 lets no lambda capture a binding
      CAPTURE(command);
      const auto refused = type(command);
      CHECK(refused.exit_code == 2);
      CHECK(refused.out.find(option) != std::string::npos);
      const auto help = type(between(refused.out, "(see ", ")"));
      CHECK(help.exit_code == 0);
      CHECK(help.out.find(std::string("  ") + option) != std::string::npos);
    }
  }
}

} // namespace advice_test
