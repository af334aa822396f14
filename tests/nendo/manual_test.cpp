// Manual pages and completions say what --help says. The judges are man, mandoc and the shells.

#include <algorithm>
#include <set>

#include <doctest/doctest.h>

#include "support/program.hpp"
#include "support/shell.hpp"

namespace manual_test {

using namespace nendo::test;

namespace {

using Words = std::vector<std::string>;

/// The first words of the lines of a section of --help, as CLI11 prints it.
Words section(const std::string& help, const std::string& heading) {
  Words words;
  bool inside = false;
  for (const std::string& line : lines_of(help)) {
    if (!line.starts_with(' ')) {
      inside = line == heading;
    } else if (inside && line.size() > 2 && line[2] != ' ') {
      words.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  return words;
}

/// "-i,--interval" of any section becomes two.
std::set<std::string> options_in(const std::string& help) {
  std::set<std::string> options;
  for (const std::string& line : lines_of(help)) {
    if (!line.starts_with("  -")) continue;
    std::istringstream names(line.substr(2, line.find(' ', 2) - 2));
    for (std::string name; std::getline(names, name, ',');)
      options.insert(name);
  }
  return options;
}

std::string help_of(Words words) {
  words.emplace_back("--help");
  const auto done = nendo::test::nendo(words);
  REQUIRE(done.exit_code == 0);
  return done.out;
}

/// Every command line that has a --help: {"udev"}, {"udev", "bind"}, ...
std::vector<Words> command_lines() {
  std::vector<Words> lines;
  for (const std::string& command : section(help_of({}), "Subcommands:")) {
    lines.push_back({command});
    for (const std::string& inner : section(help_of({command}), "Subcommands:"))
      lines.push_back({command, inner});
  }
  return lines;
}

class Manual {
public:
  Manual() {
    const auto written = shell("'" NENDO_MANUAL "' '" + folder_.path().string() + "' 2026-01-02");
    REQUIRE_MESSAGE(written.exit_code == 0, written.out);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// What readline would offer for the words, of which the last one is being typed.
  std::set<std::string> bash(const std::string& words) const {
    const auto done = shell("bash -euc 'source " + path("nendo.bash") + "; COMP_WORDS=(" + words +
                            "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _nendo; "
                            "printf \"%s\\n\" \"${COMPREPLY[@]}\"'");
    REQUIRE_MESSAGE(done.exit_code == 0, done.out);
    std::set<std::string> offered;
    for (const std::string& word : lines_of(done.out))
      if (!word.empty()) offered.insert(word);
    return offered;
  }

private:
  TemporaryFolder folder_;
};

std::string joined(const Words& words) {
  std::string text;
  for (const std::string& word : words)
    text += word + ' ';
  return text;
}

} // namespace

TEST_SUITE("manual") {
  TEST_CASE("every command has a page with every option of its --help, and man has no complaint") {
    const Manual manual;
    std::set<std::string> pages{"nendo.1"};
    const auto lines = command_lines();
    REQUIRE(lines.size() > 20);
    std::string shown;
    for (const Words& line : lines) {
      const std::string page = "nendo-" + line[0] + ".1";
      if (pages.insert(page).second) {
        const auto rendered = shell("MANWIDTH=400 man --warnings -P cat -E ascii -l " +
                                    manual.path(page) + " >" + manual.path("text") + "; col -b <" +
                                    manual.path("text") + " >" + manual.path("plain"));
        CHECK_MESSAGE(rendered.out.empty(), rendered.out);
        shown = contents(manual.path("plain"));
        REQUIRE(shown.find("SYNOPSIS") != std::string::npos);
      }
      const std::string help = help_of(line);
      const std::string usage = lines_of(help.substr(help.find("[OPTIONS]"))).front();
      if (usage.find("SUBCOMMAND") == std::string::npos)
        CHECK_MESSAGE(shown.find("nendo " + joined(line) + usage + '\n') != std::string::npos,
                      page << ": " << usage);
      for (const std::string& option : options_in(help)) {
        const bool found = shown.find(' ' + option + ' ') != std::string::npos ||
                           shown.find(' ' + option + '\n') != std::string::npos ||
                           shown.find(' ' + option + ',') != std::string::npos;
        CHECK_MESSAGE(found, page << ": " << option);
      }
    }
    for (const std::string& page : pages) {
      const auto lint = shell("mandoc -T lint -W warning " + manual.path(page));
      CHECK_MESSAGE(lint.out.empty(), lint.out);
    }
    CHECK(contents(manual.path("nendo-udev.1")).find("2026-01-02") != std::string::npos);
  }

  TEST_CASE("the control: mandoc and man complain of a page that is broken") {
    const TemporaryFolder folder;
    const std::string page = (folder.path() / "broken.1").string();
    write_file(page, ".TH X 1\n.SH NAME\nx \\- y\n.nosuchrequest\n.TP\n");
    CHECK_FALSE(shell("mandoc -T lint -W warning " + page).out.empty());
    CHECK_FALSE(shell("man --warnings -P cat -l " + page + " >/dev/null").out.empty());
  }

  TEST_CASE("nendo-manual names a folder that cannot be written, and its usage") {
    const auto failed = shell("'" NENDO_MANUAL "' /proc/manual 2026-01-02 2>&1");
    CHECK(failed.exit_code == 1);
    CHECK(failed.out.find("/proc/manual/nendo.1") != std::string::npos);
    const auto usage = shell("'" NENDO_MANUAL "' 2>&1");
    CHECK(usage.exit_code == 2);
    CHECK(usage.out.find("nendo-manual FOLDER DATE") != std::string::npos);
  }

  TEST_CASE("bash completes commands, options and values") {
    const Manual manual;
    CHECK(manual.bash("nendo --v") == std::set<std::string>{"--version"});
    CHECK(manual.bash("nendo ru") == std::set<std::string>{"run"});
    CHECK(manual.bash("nendo udev bind /dev/ttyUSB0 --as \"\"") ==
          std::set<std::string>{"left", "right", "tracker"});
    CHECK(manual.bash("nendo udev unbind \"\"") ==
          std::set<std::string>{"left", "right", "tracker"});
    CHECK(manual.bash("nendo emulate --pace h") == std::set<std::string>{"host"});
    CHECK(manual.bash("nendo run --mesh \"\"").empty()); // bash then offers files
    CHECK(manual.bash("nendo run --left sim --mes") == std::set<std::string>{"--mesh"});
    const auto commands = section(help_of({}), "Subcommands:");
    CHECK(manual.bash("nendo \"\"") == std::set<std::string>(commands.begin(), commands.end()));
    for (const Words& line : command_lines()) {
      std::set<std::string> wanted = options_in(help_of(line));
      CHECK_MESSAGE(manual.bash("nendo " + joined(line) + "-") == wanted, joined(line));
    }
  }

  TEST_CASE("fish completes them, too, and zsh understands its script") {
    const Manual manual;
    const auto fish = [&](const std::string& line) {
      return shell("HOME=" + manual.path("") + " fish --no-config -c 'source " +
                   manual.path("nendo.fish") + "; complete -C \"" + line + "\"'")
          .out;
    };
    CHECK(fish("nendo ru").starts_with("run\tShapes a model"));
    CHECK(fish("nendo udev bind --as ").find("left") != std::string::npos);
    for (const std::string& option : options_in(help_of({"udev", "bind"}))) {
      if (!option.starts_with("--")) continue;
      CHECK_MESSAGE(fish("nendo udev bind --").find(option) != std::string::npos, option);
    }
    CHECK(fish("nendo run --").find("--by-place") == std::string::npos);
    const auto zsh = shell("zsh -n " + manual.path("_nendo"));
    CHECK(zsh.exit_code == 0);
    CHECK_MESSAGE(zsh.out.empty(), zsh.out);
  }
}

} // namespace manual_test
