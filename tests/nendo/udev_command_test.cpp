// nendo udev: what it writes, what it leaves alone, and what it says of that.

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <nendo/udev/rules.hpp>

#include "support/program.hpp"

namespace udev_command_test {

using namespace nendo::test;
namespace fs = std::filesystem;

namespace {

/// `nendo udev WORDS --root FOLDER`.
class FakeRoot {
public:
  Finished udev(std::vector<std::string> words) const {
    words.insert(words.begin(), "udev");
    words.insert(words.end(), {"--root", folder_.path().string()});
    return nendo::test::nendo(words);
  }
  fs::path etc(const std::string& name = "") const {
    return folder_.path() / "etc/udev/rules.d" / name;
  }
  fs::path package(const std::string& name) const {
    const fs::path folder = folder_.path() / "usr/lib/udev/rules.d";
    fs::create_directories(folder);
    return folder / name;
  }
  std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      count += entry.is_directory() ? 0U : 1U;
    return count;
  }

private:
  TemporaryFolder folder_;
};

bool contains(const Finished& done, std::string_view text) {
  return done.out.find(text) != std::string::npos;
}

} // namespace

TEST_SUITE("udev command") {
  TEST_CASE("install writes what show prints, once, for everybody to read") {
    const FakeRoot root;
    const auto dry = root.udev({"install", "--dry-run"});
    CHECK(dry.exit_code == 0);
    CHECK(contains(dry, "would write"));
    CHECK(root.files() == 0);
    ::umask(077);
    const auto first = root.udev({"install"});
    ::umask(022);
    CHECK(first.exit_code == 0);
    CHECK(lines_of(first.out).size() == 2); // no word of udev: this is not its root
    for (const auto& file : nendo::udev::shipped_rules()) {
      const auto path = root.etc(std::string(file.name));
      CHECK(contents(path) == file.text);
      CHECK(root.udev({"show", std::string(file.name)}).out == file.text);
      CHECK((fs::status(path).permissions() & fs::perms::all) == fs::perms(0644));
    }
    const auto written = fs::last_write_time(root.etc("60-nendo.rules"));
    const auto second = root.udev({"install"});
    CHECK(second.exit_code == 0);
    CHECK(contains(second, "unchanged"));
    CHECK_FALSE(contains(second, "wrote"));
    CHECK(fs::last_write_time(root.etc("60-nendo.rules")) == written);
    CHECK(root.files() == 2);
  }

  TEST_CASE("uninstall removes what install wrote, and a second one says that nothing is there") {
    const FakeRoot root;
    CHECK(root.udev({"install"}).exit_code == 0);
    CHECK(contains(root.udev({"uninstall", "--dry-run"}), "would remove"));
    CHECK(root.files() == 2);
    CHECK(contains(root.udev({"uninstall"}), "removed"));
    CHECK(root.files() == 0);
    const auto again = root.udev({"uninstall"});
    CHECK(again.exit_code == 0);
    CHECK(contains(again, "missing"));
  }

  TEST_CASE("a package's rules are enough, and are not touched") {
    const FakeRoot root;
    for (const auto& file : nendo::udev::shipped_rules())
      write_file(root.package(std::string(file.name)), file.text);
    CHECK(contains(root.udev({"install"}), "unchanged"));
    CHECK(root.files() == 2);
    CHECK(contains(root.udev({"uninstall"}), "kept"));
    CHECK(root.files() == 2);
    // An older package's are overridden from /etc.
    write_file(root.package("60-nendo.rules"), "# Made by nendo: long ago\n");
    CHECK(contains(root.udev({"show"}), "of another version"));
    CHECK(contains(root.udev({"install"}), "wrote " + root.etc("60-nendo.rules").string()));
    CHECK(root.files() == 3);
  }

  TEST_CASE("somebody else's file or link under that name is left alone") {
    for (const bool link : {false, true}) {
      const FakeRoot root;
      fs::create_directories(root.etc());
      const auto path = root.etc("60-nendo.rules");
      if (link) {
        fs::create_symlink("/dev/null", path); // how administrators switch rules off
      } else {
        write_file(path, "# mine\n");
      }
      const auto done = root.udev({"install"});
      CHECK(done.exit_code == 1);
      CHECK(is_one_line_about(done.err, path.string()));
      CHECK(root.udev({"uninstall"}).err.find(path.string()) != std::string::npos);
      CHECK(fs::is_symlink(path) == link);
      CHECK(root.files() == 1);
    }
  }

  TEST_CASE("a bindings file that is a link is not followed") {
    const FakeRoot root;
    fs::create_directories(root.etc());
    const TemporaryFolder elsewhere;
    const auto target = elsewhere.path() / "target";
    write_file(target, "ATTRS{serial}==\"A1\", ENV{ID_NENDO_GLOVE}=\"1\", "
                       "ENV{ID_NENDO_HAND}=\"left\"\n");
    const std::string before = contents(target);
    fs::create_symlink(target, root.etc("60-nendo-local.rules"));
    CHECK(root.udev({"unbind", "left"}).exit_code == 1);
    CHECK(contents(target) == before);
  }

  TEST_CASE("without the right to write it says so, and asks for sudo") {
    if (::geteuid() == 0) return; // who may write everywhere
    const auto done = nendo::test::nendo({"udev", "install", "--root", "/proc"});
    CHECK(done.exit_code == 4);
    CHECK(is_one_line_about(done.err, "sudo"));
  }

  TEST_CASE("ports and words that there are not bind nothing") {
    const FakeRoot root;
    const auto done = root.udev({"bind", "/dev/ttyUSB77", "--as", "left"});
    CHECK(done.exit_code == 3);
    CHECK(is_one_line_about(done.err, "/dev/ttyUSB77"));
    CHECK(root.udev({"bind", "/dev/ttyUSB77", "--as", "third"}).exit_code == 2);
    CHECK(root.udev({"bind", "/dev/ttyUSB77"}).exit_code == 2);
    CHECK(root.udev({"show", "70-other.rules"}).exit_code == 2);
    CHECK(root.udev({"unbind", "left"}).exit_code == 0);
    CHECK(root.files() == 0);
  }
}

} // namespace udev_command_test
