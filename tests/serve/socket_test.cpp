#include "serve/socket.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/required.hpp"
#include "support/runtime_folder.hpp"
#include "support/temporary_folder.hpp"

namespace socket_test {

using namespace nendo;
using serve::parse_target;
using serve::Socket;
using test::required;
namespace fs = std::filesystem;

namespace {

unsigned mode_of(const std::string& path) {
  struct stat status{};
  REQUIRE(::lstat(path.c_str(), &status) == 0);
  return status.st_mode & 07777U;
}

/// The error number of connecting; 0: connected.
int connect_to(const std::string& path) {
  const UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0
             ? 0
             : errno;
}

void check_refused(const Result<Socket>& socket, Errc code, const std::string& words) {
  REQUIRE_FALSE(socket);
  CAPTURE(socket.error().message);
  CHECK(socket.error().code == code);
  CHECK(socket.error().message.find(words) != std::string::npos);
  CHECK(socket.error().message.find('\n') == std::string::npos);
}

} // namespace

TEST_SUITE("serve_socket") {
  TEST_CASE("a server has a name, and may have a group") {
    CHECK(required(parse_target("")).name == "hands");
    CHECK(required(parse_target("lab-1")).name == "lab-1");
    CHECK_FALSE(required(parse_target("lab-1")).group);
    CHECK(required(parse_target("?group=root")).group == 0U);
    CHECK(required(parse_target("x?group=1234")).group == 1234U);
    for (const char* wrong : {"a/b", "a b", "x?group", "x?group=no-such-group-1", "x?mode=1"})
      CHECK(parse_target(wrong).error().code == Errc::usage);
  }

  TEST_CASE("a user's socket is in the user's folder, for this user alone") {
    const test::RuntimeFolder runtime;
    const driver::ServeFolders folders = driver::serve_folders();
    CHECK(folders.own == (runtime.path() / "nendo").string());
    CHECK(folders.services == "/run/nendo");
    const mode_t before = ::umask(0); // it has no part in the modes
    {
      Socket socket = required(Socket::claim({}, {folders.own, ""}));
      ::umask(before);
      CHECK(socket.path() == folders.own + "/hands.sock");
      CHECK(mode_of(socket.path()) == 0600);
      CHECK(mode_of(folders.own) == 0700);
      CHECK(connect_to(socket.path()) == ECONNREFUSED); // clients need not wait
      test::require_ok(socket.listen());
      CHECK(connect_to(socket.path()) == 0);
    }
    CHECK(fs::is_empty(folders.own)); // the lock, also
    Socket socket = required(Socket::claim({"x", ::getegid()}, {folders.own, ""}));
    CHECK(mode_of(socket.path()) == 0660);
  }

  TEST_CASE("a service's socket is in the folder of services, if it may write there") {
    const test::TemporaryFolder folder;
    const std::string services = (folder.path() / "run").string();
    const std::string own = (folder.path() / "own").string();
    CHECK(required(Socket::claim({}, {own, services})).path() == own + "/hands.sock");
    fs::create_directory(services);
    CHECK(required(Socket::claim({}, {own, services})).path() == services + "/hands.sock");
    if (::geteuid() == 0) return; // may write everywhere
    fs::permissions(services, fs::perms::owner_read | fs::perms::owner_exec);
    CHECK(required(Socket::claim({}, {own, services})).path() == own + "/hands.sock");
  }

  TEST_CASE("a name has one living server, and a dead one's socket is replaced") {
    const test::TemporaryFolder folder;
    const driver::ServeFolders folders{(folder.path() / "nendo").string(), ""};
    {
      const Socket first = required(Socket::claim({}, folders));
      check_refused(Socket::claim({}, folders), Errc::failed, "another program shares devices");
      CHECK(connect_to(first.path()) == ECONNREFUSED); // it is still the first one's
      CHECK(required(Socket::claim({"other"}, folders)).path() == folders.own + "/other.sock");
    }
    const pid_t child = ::fork();
    if (child == 0) { // ends as if killed
      auto socket = Socket::claim({}, folders);
      ::_exit(socket ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WEXITSTATUS(status) == 0);
    REQUIRE(fs::exists(folders.own + "/hands.sock"));
    Socket next = required(Socket::claim({}, folders));
    test::require_ok(next.listen());
    CHECK(connect_to(next.path()) == 0);
  }

  TEST_CASE("other files and strange folders stay as they are") {
    const test::TemporaryFolder folder;
    const std::string own = (folder.path() / "nendo").string();
    fs::create_directory(own);
    fs::permissions(own, fs::perms::owner_all);
    std::ofstream(own + "/hands.sock") << "mine";
    check_refused(Socket::claim({}, {own, ""}), Errc::failed, "no socket of yours");
    CHECK(fs::file_size(own + "/hands.sock") == 4);
    fs::create_symlink("/nowhere", own + "/link.sock");
    check_refused(Socket::claim({"link"}, {own, ""}), Errc::failed, "no socket of yours");
    fs::permissions(own, fs::perms::all);
    check_refused(Socket::claim({"x"}, {own, ""}), Errc::no_permission, "no other user");
    const std::string link = (folder.path() / "link").string();
    fs::create_directory_symlink(own, link);
    check_refused(Socket::claim({"x"}, {link, ""}), Errc::no_permission, "a folder of yours");
    check_refused(Socket::claim({"x"}, {"", ""}), Errc::failed, "XDG_RUNTIME_DIR");
    const std::string deep = (folder.path() / std::string(90, 'd')).string();
    check_refused(Socket::claim({"x"}, {deep, ""}), Errc::failed, "longer than a socket's path");
  }
}

} // namespace socket_test
