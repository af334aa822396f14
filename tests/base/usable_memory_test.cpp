#include <nendo/base/usable_memory.hpp>

#include <fstream>
#include <limits>

#include <doctest/doctest.h>

#include "support/temporary_folder.hpp"

namespace usable_memory_test {

using namespace nendo;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& path, const char* text) {
  std::ofstream(path) << text;
}

} // namespace

TEST_SUITE("usable_memory") {
  TEST_CASE("the least limit of a process' group and of those above it holds") {
    const test::TemporaryFolder folder;
    const fs::path root = folder.path() / "cgroup";
    const fs::path membership = folder.path() / "membership";
    fs::create_directories(root / "system.slice" / "nendo@bench.service");
    const auto limit = [&](const char* group, const char* text) {
      write(root / group / "memory.max", text);
      return group_memory_limit(membership, root);
    };
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    CHECK(group_memory_limit(membership, root) == none);
    write(membership, "12:cpu:/elsewhere\n0::/system.slice/nendo@bench.service\n");
    CHECK(group_memory_limit(membership, root) == none);
    CHECK(limit("system.slice/nendo@bench.service", "max\n") == none);
    CHECK(limit("system.slice/nendo@bench.service", "8000000\n") == 8'000'000);
    CHECK(limit("system.slice", "5000000\n") == 5'000'000);
    CHECK(limit("", "6000000\n") == 5'000'000);
  }

  TEST_CASE("this machine has some memory, and not more than there is in the world") {
    CHECK(usable_memory() > std::size_t{1} << 20);
    CHECK(usable_memory() < std::size_t{1} << 60);
  }
}

} // namespace usable_memory_test
