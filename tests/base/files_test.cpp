#include <nendo/base/files.hpp>

#include <fstream>
#include <iterator>

#include <doctest/doctest.h>

#include <nendo/base/file_replacement.hpp>

#include "support/temporary_folder.hpp"

using namespace nendo;
namespace fs = std::filesystem;

namespace {

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
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
    REQUIRE(file.finish());
    CHECK(read() == "new, in two");
    CHECK(entries(folder.path()) == 1);
    CHECK_FALSE(FileReplacement::begin(folder.path()));
  }
}
