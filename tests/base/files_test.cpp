#include <nendo/base/files.hpp>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "support/temporary_folder.hpp"

namespace files_test {

using namespace nendo;
namespace fs = std::filesystem;

namespace {

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

/// What is there without its own name yet, or never got it.
std::vector<fs::path> temporaries_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".tmp") found.push_back(entry.path());
  return found;
}

} // namespace

TEST_SUITE("files") {
  TEST_CASE("what was written is read back, whatever its bytes, up to the limit and no farther") {
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "file";
    constexpr std::uint64_t limit = 1U << 20U;
    for (const std::size_t size : {0U, 1U, 5000U, 1U << 20U}) {
      std::string contents(size, '\n');
      if (size > 1) contents[1] = '\0';
      REQUIRE(replace_file(path, contents));
      const auto read = read_file(path, limit, "test");
      REQUIRE(read);
      CHECK(*read == contents);
    }
    REQUIRE(replace_file(path, std::string(limit + 1, 'x')));
    const auto large = read_file(path, limit, "test");
    REQUIRE_FALSE(large);
    CHECK(large.error().code == Errc::bad_input);
    CHECK(large.error().message == path.string() + ": is larger than 1 MiB, so it is no test");
    CHECK(entries(folder.path()) == 1);
  }

  TEST_CASE("a file that is longer than the system says is read to its end") {
    const auto status = read_file("/proc/self/status", 1U << 20U, "status"); // says 0
    REQUIRE(status);
    CHECK(status->starts_with("Name:"));
    CHECK(status->ends_with('\n'));
    CHECK_FALSE(read_file("/proc/self/status", 100, "status"));
  }

  TEST_CASE("a link is followed, and what is no file is refused") {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "file";
    const fs::path link = folder.path() / "link";
    std::ofstream(file) << "old";
    fs::create_symlink(file, link);
    CHECK(target_of(link) == fs::canonical(file));
    REQUIRE(replace_file(link, "new"));
    CHECK(fs::is_symlink(fs::symlink_status(link)));
    const auto read = read_file(file, 100, "test");
    REQUIRE(read);
    CHECK(*read == "new");
    for (const auto& path : {folder.path(), fs::path("/dev/null"), folder.path() / "none" / "x"}) {
      CAPTURE(path);
      const auto written = replace_file(path, "new");
      REQUIRE_FALSE(written);
      CHECK(written.error().code == Errc::failed);
      CHECK(written.error().message.starts_with(path.string() + ": "));
      CHECK_FALSE(read_file(path, 100, "test"));
    }
    CHECK(entries(folder.path()) == 2);
    fs::remove(file);
    fs::create_symlink("link", folder.path() / "again"); // a chain, and nothing at its end
    REQUIRE(replace_file(folder.path() / "again", "made"));
    CHECK(fs::is_symlink(fs::symlink_status(folder.path() / "again")));
    CHECK(fs::is_symlink(fs::symlink_status(link)));
    CHECK(*read_file(file, 100, "test") == "made");
    fs::create_symlink("round", folder.path() / "round");
    CHECK(target_of(folder.path() / "round") == folder.path() / "round");
  }

  TEST_CASE("a file written piece by piece has its name when it is whole, and not before") {
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "file";
    REQUIRE(replace_file(path, "old"));
    const auto read = [&] { return *read_file(path, 100, "test"); };
    {
      auto dropped = FileReplacement::begin(path);
      REQUIRE(dropped);
      REQUIRE(dropped->write(std::string_view("new")));
      CHECK(read() == "old");
    }
    CHECK(entries(folder.path()) == 1);
    auto begun = FileReplacement::begin(path);
    REQUIRE(begun);
    FileReplacement file = *std::move(begun);
    REQUIRE(file.write(std::string_view("new, ")));
    REQUIRE(file.write(std::string_view("in two")));
    CHECK(file.size() == 11);
    CHECK(read() == "old");
    REQUIRE(file.sync());
    CHECK(read() == "old");
    REQUIRE(file.finish());
    CHECK(read() == "new, in two");
    CHECK(entries(folder.path()) == 1);
    CHECK_FALSE(FileReplacement::begin(folder.path()));
  }

  TEST_CASE("what a killed process of the same number left beside it is passed over, and stays") {
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "file";
    std::string begin;
    unsigned long number = 0;
    {
      const auto begun = FileReplacement::begin(path);
      REQUIRE(begun);
      REQUIRE(temporaries_in(folder.path()).size() == 1);
      begin = temporaries_in(folder.path()).front().stem().string(); // ".nendo.PID.COUNT"
      const auto last_dot = begin.rfind('.');
      number = std::stoul(begin.substr(last_dot + 1));
      begin.resize(last_dot + 1);
    }
    const auto leave = [&](unsigned long next) {
      const fs::path left = folder.path() / (begin + std::to_string(next) + ".tmp");
      std::ofstream(left) << "left";
      return left;
    };
    std::vector<fs::path> leftovers;
    for (unsigned long next = number + 1; next <= number + 20; ++next)
      leftovers.push_back(leave(next));
    REQUIRE(replace_file(path, "new"));
    CHECK(*read_file(path, 100, "test") == "new");
    for (const auto& left : leftovers)
      CHECK(*read_file(left, 100, "test") == "left");
    CHECK(entries(folder.path()) == 21);
    for (unsigned long next = number + 21; next <= number + 1000; ++next) // without end
      leave(next);
    const auto written = replace_file(path, "newer");
    REQUIRE_FALSE(written);
    CHECK(written.error().message.starts_with(path.string() + ": "));
    CHECK(*read_file(path, 100, "test") == "new");
  }

  TEST_CASE("a file that is replaced keeps its mode, and a new one has what the umask leaves") {
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "file";
    const auto mode = [](const fs::path& of) { return fs::status(of).permissions(); };
    const mode_t before = ::umask(027);
    REQUIRE(replace_file(path, "secret"));
    CHECK(mode(path) == fs::perms(0640));
    for (const unsigned kept : {0600U, 0400U, 0666U, 0755U}) {
      fs::permissions(path, fs::perms(kept));
      auto begun = FileReplacement::begin(path);
      REQUIRE(begun);
      REQUIRE(temporaries_in(folder.path()).size() == 1);
      CHECK(mode(temporaries_in(folder.path()).front()) == fs::perms(kept)); // before a byte is in
      REQUIRE(begun->write(std::string_view("more")));
      REQUIRE(begun->finish());
      CHECK(mode(path) == fs::perms(kept));
    }
    ::umask(before);
  }
}

} // namespace files_test
