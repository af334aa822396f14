#include "line/pseudo_terminal.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

namespace nendo::emulator {

namespace fs = std::filesystem;

SymbolicLink::~SymbolicLink() {
  if (path_.empty()) return;
  std::error_code error;
  if (fs::read_symlink(path_, error) == target_ && !error) fs::remove(path_, error);
}

Result<SymbolicLink> SymbolicLink::make(const std::string& where, const std::string& target) {
  const auto failed = [&where](const std::string& why) {
    return Error{Errc::failed, "link " + where + ": cannot make it: " + why};
  };
  std::error_code error;
  const fs::path path = fs::absolute(where, error);
  if (error) return failed(error.message());
  if (!fs::is_directory(path.parent_path(), error)) {
    return failed("there is no folder " + path.parent_path().string());
  }
  const fs::file_status old = fs::symlink_status(path, error);
  if (fs::exists(old) && !fs::is_symlink(old)) {
    return failed(
        "its place is taken by something that is not a link; remove that or choose another path");
  }
  const fs::path temporary = path.string() + "." + std::to_string(::getpid());
  fs::create_symlink(target, temporary, error);
  if (error) return failed(error.message());
  fs::rename(temporary, path, error);
  if (error) {
    const std::string why = error.message();
    fs::remove(temporary, error);
    return failed(why);
  }
  return SymbolicLink(path, target);
}

Result<PseudoTerminal> PseudoTerminal::make(const std::string& link) {
  const auto failed = [] {
    return Error{Errc::failed,
                 "cannot make a pseudo-terminal: " + std::generic_category().message(errno)};
  };
  PseudoTerminal terminal(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  const int fd = terminal.fd();
  std::array<char, 64> name{};
  termios raw{};
  if (fd < 0 || ::grantpt(fd) != 0 || ::unlockpt(fd) != 0 ||
      ::ptsname_r(fd, name.data(), name.size()) != 0 || ::tcgetattr(fd, &raw) != 0) {
    return failed();
  }
  ::cfmakeraw(&raw);
  ::cfsetspeed(&raw, B115200);
  if (::tcsetattr(fd, TCSANOW, &raw) != 0) return failed();
  // Only a terminal that was opened once tells poll() that nobody has it open.
  const int once = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (once < 0) return failed();
  ::close(once);
  terminal.path_ = name.data();
  if (!link.empty()) {
    auto made = SymbolicLink::make(link, terminal.path_);
    if (!made) return made.error();
    terminal.link_.emplace(*std::move(made));
  }
  return terminal;
}

} // namespace nendo::emulator
