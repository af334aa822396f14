#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include "support/program.hpp"

namespace lost_output_test {

using nendo::test::contents;
using nendo::test::Finished;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::Program;
using nendo::test::TemporaryFolder;
using nendo::test::write_file;

namespace {

using Arguments = std::vector<std::string>;

/// A descriptor that programs which are started later do not inherit, except as their output.
class Output {
public:
  /// Takes every byte and keeps none: the disk is full.
  static Output full() { return Output(::open("/dev/full", O_WRONLY | O_CLOEXEC)); }
  /// A pipe whose reader has gone, as `head` goes.
  static Output unread() {
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return Output(-1);
    ::close(ends[0]);
    return Output(ends[1]);
  }
  ~Output() { ::close(fd_); }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  int fd() const noexcept { return fd_; }

private:
  explicit Output(int fd) : fd_(fd) { REQUIRE(fd >= 0); }
  int fd_;
};

/// A variable of the environment, as long as this lives.
class Variable {
public:
  Variable(std::string name, const std::string& value) : name_(std::move(name)) {
    if (const char* const before = std::getenv(name_.c_str())) before_ = before;
    ::setenv(name_.c_str(), value.c_str(), 1);
  }
  ~Variable() {
    before_ ? ::setenv(name_.c_str(), before_->c_str(), 1) : ::unsetenv(name_.c_str());
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

private:
  std::string name_;
  std::optional<std::string> before_;
};

std::string line_of(const Arguments& arguments) {
  std::string line = "nendo";
  for (const auto& argument : arguments)
    line += ' ' + argument;
  return line;
}

Finished with_output(const Arguments& arguments, const Output& output) {
  return Program(arguments, output.fd()).wait();
}

/// What the commands work on: a stored calibration, a run, a take of a glove, a timeline.
class Workshop {
public:
  Workshop() {
    write_file(folder_.path() / "c.csv",
               "sensor,gain_rad_per_count,offset_counts\nindex_mcp,0.0125,60\n");
    made({"calibration", "import", at("c.csv"), "--user", "una", "--hand", "right"});
    made({"run", "--left", "sim", "--right", "sim:grasp", "--duration", "0.6", "--out", at("s.obj"),
          "--record", at("run.nendo")});
    made({"record", "sim", "--duration", "0.3", "--out", at("take.nendo")});
    made({"edit", "make", at("run.nendo"), "--out", at("t.timeline.toml")});
  }

  std::string at(const std::string& name) const { return (folder_.path() / name).string(); }

private:
  static void made(const Arguments& arguments) {
    const auto done = nendo::test::nendo(arguments);
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  }

  const TemporaryFolder folder_;
  const Variable home_{"XDG_CONFIG_HOME", folder_.path().string()};
};

/// Every command that prints; none of them ends before it has printed, but by itself or because
/// what it prints is lost.
std::vector<Arguments> printing_commands(const Workshop& shop) {
  const auto at = [&](const char* name) { return shop.at(name); };
  return {
      {"--help"},
      {"--version"},
      {"monitor", "--help"},
      {"monitor", "sim", "--json"}, // without end
      {"monitor", "sim", "--count", "3"},
      {"poses", "sim"}, // without end
      {"poses", "sim", "--bvh", at("p.bvh"), "--duration", "0.2"},
      {"info", "sim"},
      {"info", "sim", "--json"},
      {"devices"},
      {"doctor"},
      {"udev", "show"},
      {"calibration", "list"},
      {"calibration", "show", "una"},
      {"calibration", "path"},
      {"calibration", "export", "una", "--format", "toml"},
      {"calibration", "export", "una", "--format", "csv"},
      {"run", "--left", "sim", "--json", "--out", at("a.obj")}, // without end
      {"run", "--left", "sim", "--duration", "0.2", "--out", at("b.obj")},
      {"stress", "--json", "--duration", "0.3"},
      {"stress", "--duration", "0.3"},
      {"stress", "--duration", "0.3", "--histogram", "2000"}, // more than a buffer
      {"record", "sim", "--duration", "0.2", "--out", at("r.nendo")},
      {"record", "sim", "--duration", "0.2", "--out", at("q.nendo"), "--json"},
      {"recording", "info", at("run.nendo")},
      {"recording", "info", at("run.nendo"), "--json"},
      {"recording", "check", at("run.nendo")},
      {"recording", "cut", at("run.nendo"), "--to", "1m", "--out", at("cut.nendo")},
      {"recording", "repair", at("run.nendo"), "--out", at("mended.nendo")},
      {"replay", at("run.nendo"), "--no-clock"},
      {"replay", at("run.nendo"), "--no-clock", "--json"},
      {"replay", at("run.nendo"), "--speed", "100", "--loop", "--json"}, // without end
      {"export", at("run.nendo"), "--out", at("e.csv")},
      {"edit", "show", at("t.timeline.toml")},
      {"edit", "show", at("t.timeline.toml"), "--json"},
      {"edit", "play", at("t.timeline.toml"), "--out", at("played.obj")},
      {"edit", "mirror", at("t.timeline.toml"), "--out", at("m.timeline.toml")},
      {"repair", at("s.obj"), "--out", at("repaired.obj")},
      {"repair", at("s.obj"), "--out", at("repaired.ply"), "--json"},
      {"emulate", "--link", at("glove"), "--duration", "0.2"},
  };
}

} // namespace

TEST_SUITE("lost output") {
  TEST_CASE("what cannot be written is exit code 1 and one line, whatever the command") {
    const Workshop shop;
    const Output full = Output::full();
    for (const Arguments& arguments : printing_commands(shop)) {
      const auto done = with_output(arguments, full);
      CAPTURE(line_of(arguments));
      CAPTURE(done.err);
      CHECK(done.exit_code == 1);
      REQUIRE_FALSE(lines_of(done.err).empty());
      CHECK(lines_of(done.err).back() ==
            "nendo: standard output cannot be written: No space left on device");
      CHECK(done.seconds < 30.0);
    }
  }

  TEST_CASE("a reader that has gone ends every command without a word, as SIGPIPE would") {
    const Workshop shop;
    const Output unread = Output::unread();
    for (const Arguments& arguments : printing_commands(shop)) {
      const auto done = with_output(arguments, unread);
      CAPTURE(line_of(arguments));
      CAPTURE(done.err);
      CHECK((done.exit_code == 128 + SIGPIPE || arguments[0] == "doctor"));
      CHECK(done.err.find("cannot be written") == std::string::npos);
      CHECK(done.err.find("ipe") == std::string::npos);
      CHECK(done.seconds < 30.0);
    }
  }

  TEST_CASE("a run that nobody reads any more still writes its shape") {
    const TemporaryFolder folder;
    const auto shape = folder.path() / "shape.obj";
    const auto done = with_output({"run", "--left", "sim:grasp", "--json", "--out", shape.string()},
                                  Output::unread());
    CHECK(done.exit_code == 128 + SIGPIPE);
    CHECK(contents(shape).find("\nf ") != std::string::npos);
  }

  TEST_CASE("a closed standard output is an error, and no file gets what it should have had") {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "take.nendo").string();
    const std::string err = (folder.path() / "err").string();
    const std::string command = "'" NENDO_PROGRAM "' record sim --duration 0.2 --json --out '" +
                                out + "' >&- 2>'" + err + "'";
    const int status = std::system(command.c_str());
    CHECK(WEXITSTATUS(status) == 1);
    CHECK(is_one_line_about(contents(err), "standard output cannot be written"));
    CHECK(contents(out).find("\"event\"") == std::string::npos);
    const auto checked = nendo::test::nendo({"recording", "check", out});
    CHECK_MESSAGE(checked.exit_code == 0, checked.err);
  }
}

} // namespace lost_output_test
