#include "transport/open_transport.hpp"

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string_view>

#include <sys/stat.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include "support/required.hpp"
#include "support/scripted_port.hpp"
#include "support/temporary_folder.hpp"

namespace transport_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

} // namespace

TEST_SUITE("transport") {
  TEST_CASE("a question reaches the far end of a pseudo-terminal and its answer comes back") {
    const ScriptedPort port;
    auto transport = required(open_transport(port.path(), 115'200));
    check_that_it_answers(*transport);
  }

  TEST_CASE("a read of a quiet line ends in time with nothing") {
    const ScriptedPort port;
    auto transport = required(open_transport(port.path(), 115'200));
    std::array<std::byte, 16> buffer{};
    const auto start = std::chrono::steady_clock::now();
    const auto [status, count] = transport->read_some(buffer, 50ms);
    const auto lasted = std::chrono::steady_clock::now() - start;
    CHECK(status == IoStatus::timeout);
    CHECK(count == 0);
    CHECK(lasted >= 50ms);
    CHECK(lasted < 1s);
  }

  TEST_CASE("discarded input is never read") {
    const ScriptedPort port;
    auto transport = required(open_transport(port.path(), 115'200));
    CHECK(transport->write_all(bytes_of("?S"), 1s) == IoStatus::done);
    std::this_thread::sleep_for(100ms);
    transport->discard_input();
    std::array<std::byte, 16> buffer{};
    CHECK(transport->read_some(buffer, 20ms).status == IoStatus::timeout);
  }

  TEST_CASE("when the far end goes, reading and writing say so") {
    ScriptedPort port;
    auto transport = required(open_transport(port.path(), 115'200));
    CHECK(transport->write_all(bytes_of("?S"), 1s) == IoStatus::done);
    std::this_thread::sleep_for(100ms);
    port.unplug();
    std::array<std::byte, 16> buffer{};
    for (int reads = 0; reads < 3; ++reads) {
      if (transport->read_some(buffer, 1s).status != IoStatus::done) break;
    }
    CHECK(transport->read_some(buffer, 1s).status == IoStatus::gone);
    CHECK(transport->write_all(bytes_of("S"), 1s) == IoStatus::gone);
  }

  TEST_CASE("a far end that does not read makes a write time out, not block") {
    const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(::unlockpt(master) == 0);
    char name[128] = {};
    REQUIRE(::ptsname_r(master, name, sizeof name) == 0);
    auto transport = required(open_transport(name, 115'200));
    const std::string much(1U << 20U, 'x');
    const auto start = std::chrono::steady_clock::now();
    CHECK(transport->write_all(bytes_of(much), 100ms) == IoStatus::timeout);
    CHECK(std::chrono::steady_clock::now() - start < 2s);
    ::close(master);
  }

  TEST_CASE("a port is open for one program at a time, and free again after it") {
    const ScriptedPort port;
    for (int round = 0; round < 2; ++round) {
      auto first = required(open_transport(port.path(), 115'200));
      const auto second = open_transport(port.path(), 115'200);
      REQUIRE_FALSE(second);
      CHECK(second.error().code == Errc::no_device);
      CHECK(second.error().message.find("in use by another program") != std::string::npos);
    }
  }

  TEST_CASE("links are followed, chains and relative ones too") {
    const ScriptedPort port;
    const TemporaryFolder folder;
    std::filesystem::create_symlink(port.path(), folder.path() / "glove");
    std::filesystem::create_symlink("glove", folder.path() / "again");
    CHECK(open_transport((folder.path() / "again").string(), 115'200));
    std::filesystem::create_symlink("loop", folder.path() / "loop");
    CHECK(open_transport((folder.path() / "loop").string(), 115'200).error().code ==
          Errc::no_device);
  }

  TEST_CASE("what is missing or no terminal is no device, and nothing is changed or waited for") {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "file").string();
    std::ofstream(file) << "text";
    const std::string fifo = (folder.path() / "fifo").string();
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    const std::string missing = (folder.path() / "missing").string();
    for (const std::string& path :
         {missing, file, fifo, folder.path().string(), std::string("/dev/null")}) {
      CAPTURE(path);
      const auto transport = open_transport(path, 115'200);
      REQUIRE_FALSE(transport);
      CHECK(transport.error().code == Errc::no_device);
      CHECK(transport.error().message.find(path) != std::string::npos);
    }
    CHECK(std::filesystem::file_size(file) == 4);
  }

  TEST_CASE("a lack of permission names the group that has it and the command that joins it") {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "port").string();
    std::ofstream(path) << "";
    constexpr gid_t dialout = 20; // Debian's fixed number
    const Error root_only = open_error("/dev/null", EACCES);
    CHECK(root_only.code == Errc::no_permission);
    if (::chown(path.c_str(), static_cast<uid_t>(-1), dialout) != 0)
      return; // only root may give files away
    const Error error = open_error(path, EACCES);
    CHECK(error.code == Errc::no_permission);
    CHECK(error.message.find("sudo usermod -aG dialout $USER") ==
          std::string::npos); // 0644: no use
    std::filesystem::permissions(path, std::filesystem::perms(0660));
    CHECK(open_error(path, EACCES).message.find("sudo usermod -aG dialout $USER") !=
          std::string::npos);
  }
}

} // namespace transport_test
