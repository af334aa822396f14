#include <nendo/base/shared_name.hpp>

#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.hpp"

namespace shared_name_test {

using namespace nendo;
using Outcome = NameLock::Outcome;

TEST_SUITE("shared_name") {
  TEST_CASE("names are words of at most 64 letters, digits, dots and dashes") {
    for (const char* name : {"a", "left_1-a.B", "..", "0"})
      CHECK(is_shared_name(name));
    CHECK(is_shared_name(std::string(64, 'x')));
    for (const char* name : {"", "a/b", "a b", "\xC3\xA4", "a\n", "%"})
      CHECK_FALSE(is_shared_name(name));
    CHECK_FALSE(is_shared_name(std::string(65, 'x')));
  }

  TEST_CASE("groups are known by name and number") {
    CHECK(group_named("root") == 0U);
    CHECK(group_named("1234") == 1234U);
    CHECK_FALSE(group_named("4294967295")); // to chown() that is none
    CHECK_FALSE(group_named("no-such-group-1"));
  }

  TEST_CASE("one holder has a lock, until it releases it or is gone") {
    const test::TemporaryFolder folder;
    const std::string path = (folder.path() / ".x.lock").string();
    NameLock other(path);
    {
      NameLock first(path);
      REQUIRE(first.take() == Outcome::taken);
      CHECK(other.take() == Outcome::held);
      NameLock moved(std::move(first));
      CHECK(other.take() == Outcome::held);
    }
    CHECK_FALSE(std::filesystem::exists(path));
    CHECK(other.take() == Outcome::taken);
    other.release();
    CHECK_FALSE(std::filesystem::exists(path));
    CHECK(NameLock((folder.path() / "none" / "x").string()).take() == Outcome::failed);
  }

  TEST_CASE("the lock of a killed process is free") {
    const test::TemporaryFolder folder;
    const std::string path = (folder.path() / ".x.lock").string();
    const pid_t child = ::fork();
    if (child == 0) {
      NameLock lock(path);
      ::_exit(lock.take() == Outcome::taken ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WEXITSTATUS(status) == 0);
    REQUIRE(std::filesystem::exists(path));
    CHECK(NameLock(path).take() == Outcome::taken);
  }

  TEST_CASE("of many processes that want a lock one gets it") {
    const test::TemporaryFolder folder;
    const std::string path = (folder.path() / ".x.lock").string();
    std::array<int, 2> gate{};
    std::array<int, 2> tried{};
    REQUIRE(::pipe(gate.data()) == 0);
    REQUIRE(::pipe(tried.data()) == 0);
    constexpr int count = 8;
    for (int at = 0; at < count; ++at) {
      if (::fork() != 0) continue;
      NameLock lock(path);
      char byte = lock.take() == Outcome::taken ? 1 : 0;
      const int code = byte;
      ::close(gate[1]);
      const bool waited = ::write(tried[1], &byte, 1) == 1 && ::read(gate[0], &byte, 1) == 0;
      ::_exit(waited ? code : 2);
    }
    for (int at = 0; at < count; ++at) {
      char byte = 0;
      REQUIRE(::read(tried[0], &byte, 1) == 1);
    }
    ::close(gate[1]); // all have tried: the holder may end
    ::close(gate[0]);
    ::close(tried[0]);
    ::close(tried[1]);
    int taken = 0;
    for (int at = 0; at < count; ++at) {
      int status = 0;
      ::wait(&status);
      taken += WEXITSTATUS(status);
    }
    CHECK(taken == 1);
  }
}

} // namespace shared_name_test
