// nendo run as a service: its messages to systemd, and what systemd's own tools say of the unit.

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "service/service_notice.hpp"
#include "support/program.hpp"
#include "support/shell.hpp"

namespace service_test {

using namespace nendo::test;

namespace {

/// The other end of NOTIFY_SOCKET, as systemd has it. In the environment while this lives.
class Supervisor {
public:
  explicit Supervisor(bool abstract = false) {
    const std::string path = (folder_.path() / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    if (abstract) address.sun_path[0] = '\0';
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
    REQUIRE(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0);
    ::setenv("NOTIFY_SOCKET", (abstract ? '@' + path.substr(1) : path).c_str(), 1);
  }
  ~Supervisor() {
    ::close(socket_);
    ::unsetenv("NOTIFY_SOCKET");
  }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// What came so far, a datagram each.
  std::vector<std::string> heard() const {
    std::vector<std::string> notices;
    std::array<char, 256> text{};
    for (ssize_t got = 0; (got = ::recv(socket_, text.data(), text.size(), 0)) > 0;)
      notices.emplace_back(text.data(), static_cast<std::size_t>(got));
    return notices;
  }

private:
  TemporaryFolder folder_;
  int socket_ = -1;
};

} // namespace

TEST_SUITE("service") {
  TEST_CASE(
      "a run reports that it is ready with its first frame, that it lives, and that it stops") {
    const TemporaryFolder folder;
    const Supervisor supervisor;
    const auto done = nendo::test::nendo({"run", "--left", "sim", "--duration", "1.5", "--out",
                                          (folder.path() / "shape.obj").string()});
    CHECK(done.exit_code == 0);
    const auto notices = supervisor.heard();
    REQUIRE(notices.size() >= 3);
    CHECK(notices.front() == "READY=1\nWATCHDOG=1");
    CHECK(notices.back() == "STOPPING=1");
    for (std::size_t k = 1; k + 1 < notices.size(); ++k)
      CHECK(notices[k] == "WATCHDOG=1");
  }

  TEST_CASE("a run that never had a frame was never ready") {
    const Supervisor supervisor;
    const auto done =
        nendo::test::nendo({"run", "--left", "serial:/dev/ttyUSB77", "--duration", "1"});
    CHECK(done.exit_code != 0);
    CHECK(supervisor.heard().empty());
  }

  TEST_CASE("abstract names are understood, and children do not inherit the socket") {
    const Supervisor supervisor(true);
    nendo::service::ServiceNotice notice;
    CHECK(std::getenv("NOTIFY_SOCKET") == nullptr);
    notice.alive();
    CHECK(supervisor.heard() == std::vector<std::string>{"READY=1\nWATCHDOG=1"});
  }

  TEST_CASE("a supervisor that is gone, deaf or nonsense disturbs nothing") {
    for (const std::string& path : {std::string("/nonexistent/notify"), std::string("relative"),
                                    std::string(), '/' + std::string(300, 'x')}) {
      ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
      nendo::service::ServiceNotice notice;
      notice.alive();
      ::unsetenv("NOTIFY_SOCKET");
    }
    const Supervisor supervisor; // who does not read
    nendo::service::ServiceNotice notice;
    for (int k = 0; k < 5000; ++k)
      notice.alive();
    CHECK(supervisor.heard().front().starts_with("READY=1"));
  }

  TEST_CASE("systemd understands the units, and finds little that they expose") {
    const TemporaryFolder folder;
    std::string unit;
    for (const std::string name : {"nendo@.service", "nendo-serve.service"}) {
      CAPTURE(name);
      const std::string instance = name == "nendo@.service" ? "nendo@test.service" : name;
      unit = (folder.path() / instance).string();
      std::string text = contents(NENDO_SERVICES + name);
      REQUIRE(text.find("/usr/bin/nendo ") != std::string::npos);
      text.replace(text.find("/usr/bin/nendo "), 14, NENDO_PROGRAM); // it must be there
      write_file(unit, text);
      const auto verified = shell("systemd-analyze verify --man=no '" + unit + "'");
      CHECK_MESSAGE(verified.exit_code == 0, verified.out);
      CHECK_MESSAGE(verified.out.find(instance + ":") == std::string::npos, verified.out);
      // 100 is a service without any of it; below 30 is what systemd calls well protected.
      const auto exposure =
          shell("systemd-analyze security --no-pager --offline=yes --threshold=20 '" + unit + "'");
      CHECK_MESSAGE(exposure.exit_code == 0, exposure.out);
    }
    write_file(unit, "[Service]\nExecStart=/bin/true\nNoSuchKey=1\n"); // the control
    CHECK(shell("systemd-analyze verify --man=no '" + unit + "'").out.find("NoSuchKey") !=
          std::string::npos);
    CHECK(shell("systemd-analyze security --offline=yes --threshold=20 '" + unit + "'").exit_code !=
          0);
  }
}

} // namespace service_test
