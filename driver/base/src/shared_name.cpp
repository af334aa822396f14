#include <nendo/base/shared_name.hpp>

#include <array>

#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/base/number_in.hpp>

namespace nendo {

std::optional<unsigned> group_named(const std::string& name) {
  constexpr unsigned no_change = 0xFFFFFFFFU; // to chown()
  if (const auto number = number_in<unsigned>(name); number && *number != no_change) return number;
  group entry{};
  group* found = nullptr;
  std::array<char, 16384> buffer{};
  ::getgrnam_r(name.c_str(), &entry, buffer.data(), buffer.size(), &found);
  return found != nullptr ? std::optional(found->gr_gid) : std::nullopt;
}

bool is_same_file(int one, int other) noexcept {
  struct stat first{};
  struct stat second{};
  return ::fstat(one, &first) == 0 && ::fstat(other, &second) == 0 &&
         first.st_ino == second.st_ino && first.st_dev == second.st_dev;
}

NameLock::Outcome NameLock::take() noexcept {
  for (;;) {
    UniqueFd file(::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600));
    if (!file.is_open()) return Outcome::failed;
    struct flock lock{};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    if (::fcntl(file.get(), F_OFD_SETLK, &lock) != 0) return Outcome::held;
    const UniqueFd there(::open(path_.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!there.is_open() || !is_same_file(there.get(), file.get()))
      continue; // its holder has removed it meanwhile
    file_ = std::move(file);
    return Outcome::taken;
  }
}

void NameLock::release() noexcept {
  if (file_.is_open()) ::unlink(path_.c_str());
  file_.close();
}

} // namespace nendo
