#include "export/glb_file.hpp"

#include <limits>

#include <doctest/doctest.h>

#include "support/takes.hpp"
#include "support/temporary_folder.hpp"

namespace glb_file_test {

using namespace nendo;
using namespace nendo::exporting;

namespace {

/// With so many numbers, and with a limit.
GlbFile file_of(std::size_t numbers, std::uint64_t max_bytes) {
  GlbFile file("test", max_bytes);
  file.add_scalars(std::vector<float>(numbers, 1.0F), false);
  return file;
}

constexpr std::uint64_t all = std::numeric_limits<std::uint32_t>::max();

} // namespace

TEST_SUITE("glb_file") {
  TEST_CASE("a file that would be one byte too large is refused, and what was there stays") {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.glb";
    const auto size = file_of(1000, all).write(path);
    REQUIRE(size);
    CHECK(*size == std::filesystem::file_size(path));
    CHECK(*size > 4000);
    CHECK(file_of(1000, *size).write(path));
    test::write_bytes(path, "old");
    // By its document's few bytes, by its numbers, and by far.
    for (const std::uint64_t most : {*size - 1, std::uint64_t{3999}, std::uint64_t{10}}) {
      CAPTURE(most);
      const auto refused = file_of(1000, most).write(path);
      REQUIRE_FALSE(refused);
      CHECK(refused.error().code == Errc::failed);
      CHECK(refused.error().message.find("4 GiB") != std::string::npos);
      CHECK(refused.error().message.find("--tolerance") != std::string::npos);
      CHECK(test::file_bytes(path) == "old");
    }
  }

  TEST_CASE("numbers that are no longer kept are counted, so that no smaller file comes out") {
    const test::TemporaryFolder folder;
    GlbFile file("test", 1000);
    for (int part = 0; part < 100; ++part)
      file.add_scalars(std::vector<float>(100, 1.0F), false);
    CHECK_FALSE(file.write(folder.path() / "a.glb"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "a.glb"));
  }
}

} // namespace glb_file_test
