#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <nendo_publish.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nendo/base/units.hpp>

#include "publish/segment.hpp"
#include "support/temporary_folder.hpp"

namespace shared_memory_test {

using namespace nendo;
using namespace nendo::publish;

namespace {

constexpr std::size_t bytes = 40'000;

std::string name_for(const std::string& what) {
  return "test-" + std::to_string(::getpid()) + "-" + what;
}
std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}
std::filesystem::path path_of(const std::string& name) {
  return "/dev/shm/nendo-" + name;
}

Result<SharedMemory> announced(const std::string& name, const std::optional<unsigned>& group = {}) {
  auto memory = SharedMemory::create(name, bytes, group);
  if (!memory) return memory;
  if (const auto named = memory->announce(); !named) return named.error();
  return memory;
}

/// What a run leaves that is killed: made in another process, which ends without a destructor.
void leave_behind(const std::string& name) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto memory = announced(name);
    ::_exit(memory ? 0 : 1);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  REQUIRE(status == 0);
}

struct Removed {
  std::filesystem::path path;
  ~Removed() { std::filesystem::remove(path); }
};

} // namespace

TEST_SUITE("shared_memory") {
  TEST_CASE("it has no name before it is announced, and never gets one if it is not") {
    const std::string name = name_for("silent");
    {
      const auto memory = SharedMemory::create(name, bytes, {});
      REQUIRE(memory);
      CHECK_FALSE(std::filesystem::exists(path_of(name)));
    }
    CHECK_FALSE(std::filesystem::exists(path_of(name)));
  }

  TEST_CASE("it is zeros, that this user may read and none may write, and goes with its owner") {
    const std::string name = name_for("fresh");
    {
      const auto memory = announced(name);
      REQUIRE(memory);
      struct stat status{};
      REQUIRE(::stat(path_of(name).c_str(), &status) == 0);
      CHECK((status.st_mode & 07777) == 0400);
      CHECK(status.st_uid == ::geteuid());
      CHECK(static_cast<std::size_t>(status.st_size) == bytes);
      CHECK(static_cast<std::size_t>(status.st_blocks) * 512 >= bytes); // no page is still to come
      memory->words()[3].store(42, std::memory_order_relaxed);
      const std::string seen = contents(path_of(name));
      CHECK(seen[24] == 42);
      CHECK(seen.find_first_not_of('\0') == 24);
    }
    CHECK_FALSE(std::filesystem::exists(path_of(name)));
  }

  TEST_CASE("a group may read, if asked for") {
    const std::string name = name_for("group");
    const auto memory = announced(name, ::getegid());
    REQUIRE(memory);
    struct stat status{};
    REQUIRE(::stat(path_of(name).c_str(), &status) == 0);
    CHECK((status.st_mode & 07777) == 0440);
    CHECK(status.st_gid == ::getegid());
  }

  TEST_CASE("another user can neither write nor read it" * doctest::skip(::geteuid() != 0)) {
    const std::string name = name_for("others");
    const auto memory = announced(name);
    REQUIRE(memory);
    const std::string path = path_of(name).string();
    const pid_t child = ::fork();
    if (child == 0) {
      const bool changed = ::setgid(65534) == 0 && ::setuid(65534) == 0;
      const bool kept_out = ::open(path.c_str(), O_RDONLY | O_CLOEXEC) < 0 &&
                            ::open(path.c_str(), O_RDWR | O_CLOEXEC) < 0 &&
                            ::chmod(path.c_str(), 0666) != 0 && ::unlink(path.c_str()) != 0;
      ::_exit(changed && kept_out ? 0 : 1);
    }
    int status = -1;
    ::waitpid(child, &status, 0);
    CHECK(status == 0);
    CHECK(std::filesystem::exists(path));
  }

  TEST_CASE("what a dead run left is replaced, what a living one shows is not") {
    const std::string name = name_for("stale");
    const Removed removed{path_of(name)};
    for (int round = 0; round < 2; ++round) {
      leave_behind(name);
      std::filesystem::permissions(path_of(name), std::filesystem::perms::owner_write,
                                   std::filesystem::perm_options::add);
      write_file(path_of(name), NENDO_PUBLISH_MAGIC + std::string(bytes, 'x'));
      // Who reads the old one, and locks it as a reader can, changes nothing.
      const UniqueFd reader(::open(path_of(name).c_str(), O_RDONLY | O_CLOEXEC));
      struct flock lock{};
      lock.l_type = F_RDLCK;
      CHECK(::fcntl(reader.get(), F_OFD_SETLK, &lock) == 0);
      const auto memory = announced(name);
      REQUIRE(memory);
      CHECK(memory->words()[0].load(std::memory_order_relaxed) == 0);
      memory->words()[0].store(1, std::memory_order_relaxed);
      const auto second = announced(name);
      REQUIRE_FALSE(second);
      CHECK(second.error().code == Errc::failed);
      CHECK(second.error().message.find("another run") != std::string::npos);
      CHECK(memory->words()[0].load(std::memory_order_relaxed) == 1);
    }
  }

  TEST_CASE("of runs that find a dead one's segment in the same moment, one gets its name") {
    // Many names, one after another: wherever the system takes the processor from one run, the
    // other one comes by.
    constexpr std::size_t names = 200;
    const auto name = [](std::size_t n) { return name_for("race" + std::to_string(n)); };
    std::size_t wrong = 0;
    for (const HostTime end = HostClock::now() + std::chrono::seconds(3); HostClock::now() < end;) {
      std::array<std::vector<SharedMemory>, 2> runs;
      std::array<std::vector<bool>, 2> won;
      for (std::size_t n = 0; n < names; ++n) {
        write_file(path_of(name(n)), NENDO_PUBLISH_MAGIC);
        for (std::size_t run = 0; run < 2; ++run) {
          auto memory = SharedMemory::create(name(n), 4096, {});
          REQUIRE(memory);
          memory->words()[0].store(run, std::memory_order_relaxed);
          runs[run].push_back(*std::move(memory));
        }
      }
      std::array<std::thread, 2> threads;
      for (std::size_t run = 0; run < 2; ++run)
        threads[run] = std::thread([&, run] {
          for (auto& memory : runs[run])
            won[run].push_back(bool{memory.announce()});
        });
      for (auto& thread : threads)
        thread.join();
      for (std::size_t n = 0; n < names; ++n) {
        const char winner = won[0][n] ? '\0' : '\1';
        if (won[0][n] == won[1][n] || !contents(path_of(name(n))).starts_with(winner)) ++wrong;
      }
      for (auto& run : runs)
        run.clear();
      CHECK_FALSE(std::filesystem::exists(path_of(name(0))));
    }
    CHECK(wrong == 0);
    CHECK_FALSE(std::filesystem::exists("/dev/shm/.nendo-" + name(0) + ".lock"));
  }

  TEST_CASE("what is not Nendo's stays, and links are not followed") {
    const std::string name = name_for("strange");
    const Removed removed{path_of(name)};
    write_file(path_of(name), "another user's file");
    const auto memory = announced(name);
    REQUIRE_FALSE(memory);
    CHECK(memory.error().message.find("not Nendo's") != std::string::npos);
    CHECK(contents(path_of(name)) == "another user's file");
    std::filesystem::remove(path_of(name));

    const test::TemporaryFolder folder;
    const auto target = folder.path() / "target";
    write_file(target, std::string(NENDO_PUBLISH_MAGIC) + "precious");
    std::filesystem::create_symlink(target, path_of(name));
    CHECK_FALSE(announced(name));
    CHECK(std::filesystem::is_symlink(path_of(name)));
    CHECK(contents(target) == std::string(NENDO_PUBLISH_MAGIC) + "precious");
  }

  TEST_CASE("another user's is not touched" * doctest::skip(::geteuid() != 0)) {
    const std::string name = name_for("foreign");
    const Removed removed{path_of(name)};
    write_file(path_of(name), NENDO_PUBLISH_MAGIC "theirs");
    REQUIRE(::chown(path_of(name).c_str(), 65534, 65534) == 0);
    const auto memory = announced(name);
    REQUIRE_FALSE(memory);
    CHECK(memory.error().code == Errc::no_permission);
    CHECK(contents(path_of(name)) == NENDO_PUBLISH_MAGIC "theirs");
  }

  TEST_CASE("more than there is memory for is an error, and leaves nothing") {
    const std::string name = name_for("huge");
    const auto memory = SharedMemory::create(name, std::size_t{1} << 46, {});
    REQUIRE_FALSE(memory);
    CHECK(memory.error().code == Errc::failed);
    CHECK(memory.error().message.find(path_of(name).string()) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(path_of(name)));
  }

  TEST_CASE("a name that has become another's is left to it") {
    const std::string name = name_for("taken");
    const Removed removed{path_of(name)};
    {
      const auto memory = announced(name);
      REQUIRE(memory);
      std::filesystem::remove(path_of(name));
      write_file(path_of(name), "another's");
    }
    CHECK(contents(path_of(name)) == "another's");
  }
}

} // namespace shared_memory_test
