#include "publish/shared_memory.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo_publish.h>

namespace nendo::publish {
namespace {

constexpr const char* another_name = "choose another name: shm:NAME";

Error system_error(const std::string& path, const std::string& what, const std::string& remedy) {
  const int number = errno;
  const bool forbidden = number == EACCES || number == EPERM;
  return {forbidden ? Errc::no_permission : Errc::failed,
          path + ": " + what + ": " + std::generic_category().message(number) + "; " + remedy};
}

struct flock whole_file(short type) noexcept {
  struct flock lock{};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

// A lock for writing can be had only by who may write, which no reader may: none of them can make
// a dead writer look alive.
bool has_writer(int file) noexcept {
  struct flock lock = whole_file(F_RDLCK);
  return ::fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool is_segment(int file) noexcept {
  std::array<char, 8> magic{};
  return ::pread(file, magic.data(), magic.size(), 0) == static_cast<ssize_t>(magic.size()) &&
         std::memcmp(magic.data(), NENDO_PUBLISH_MAGIC, magic.size()) == 0;
}

// No link is followed, and a pipe is not waited for.
UniqueFd look_at(const std::string& path) noexcept {
  return UniqueFd(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
}

bool is_same(int one, int other) noexcept {
  struct stat first{};
  struct stat second{};
  return ::fstat(one, &first) == 0 && ::fstat(other, &second) == 0 &&
         first.st_ino == second.st_ino && first.st_dev == second.st_dev;
}

Error taken(const std::string& path) {
  return {Errc::failed,
          path + ": another run publishes there; end it or " + std::string(another_name)};
}

// Of the right to give `path` to another file: two runs that both find a dead one's there must not
// both remove it, for the second would remove the first's. A lock on that file would not do,
// because readers may hold locks for reading on it; this one no reader can open. It goes with its
// holder.
class NameLock {
public:
  explicit NameLock(const std::string& path)
      : path_("/dev/shm/." + path.substr(path.rfind('/') + 1) + ".lock") {}
  ~NameLock() {
    if (file_.is_open()) ::unlink(path_.c_str());
  }
  NameLock(const NameLock&) = delete;
  NameLock& operator=(const NameLock&) = delete;

  /// Does not wait. Errors: as SharedMemory::announce().
  Result<void> take(const std::string& path) {
    for (;;) {
      UniqueFd file(::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600));
      if (!file.is_open()) return system_error(path_, "cannot be made", another_name);
      struct flock lock = whole_file(F_WRLCK);
      if (::fcntl(file.get(), F_OFD_SETLK, &lock) != 0) return taken(path);
      const UniqueFd there = look_at(path_);
      if (!there.is_open() || !is_same(there.get(), file.get())) continue; // its holder has gone
      file_ = std::move(file);
      return {};
    }
  }

private:
  std::string path_;
  UniqueFd file_;
};

// Removes a dead run's segment; anything else stays.
Result<void> remove_stale(const std::string& path) {
  const UniqueFd old = look_at(path);
  if (!old.is_open()) {
    if (errno == ENOENT) return {};
    return system_error(path, "cannot be looked at", another_name);
  }
  struct stat status{};
  if (::fstat(old.get(), &status) != 0 || status.st_uid != ::geteuid())
    return Error{Errc::no_permission, path + ": belongs to another user; " + another_name};
  if (has_writer(old.get())) return taken(path);
  if (!is_segment(old.get()))
    return Error{Errc::failed, path + ": is not Nendo's; remove it or " + another_name};
  if (::unlink(path.c_str()) != 0 && errno != ENOENT)
    return system_error(path, "cannot be removed", another_name);
  return {};
}

} // namespace

Result<SharedMemory> SharedMemory::create(const std::string& name, std::size_t bytes,
                                          const std::optional<unsigned>& group) {
  const std::string path = "/dev/shm/nendo-" + name;
  UniqueFd file(::open("/dev/shm", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (!file.is_open())
    return system_error(path, "cannot be made", "is /dev/shm there, and may you write to it?");
  SharedMemory made(path, std::move(file), bytes);
  if (const auto laid = made.lay_out(group); !laid) return laid.error();
  return made;
}

Result<void> SharedMemory::lay_out(const std::optional<unsigned>& group) {
  struct flock lock = whole_file(F_WRLCK);
  if (::fcntl(file_.get(), F_OFD_SETLK, &lock) != 0)
    return system_error(path_, "cannot be locked", another_name);
  // Otherwise a full /dev/shm would be found out by the first tick that writes there, by a signal.
  if (const int error = ::posix_fallocate(file_.get(), 0, static_cast<off_t>(bytes_)); error != 0) {
    errno = error;
    return system_error(path_, "has no space for " + std::to_string((bytes_ >> 20U) + 1) + " MiB",
                        "mount -o remount,size=... /dev/shm, or a smaller model");
  }
  memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0);
  if (memory_ == MAP_FAILED) {
    memory_ = nullptr;
    return system_error(path_, "cannot be mapped", "a smaller model");
  }
  locked_ = ::mlock(memory_, bytes_) == 0;
  std::memset(memory_, 0, bytes_); // each page is touched before the first tick
  if (group && ::fchown(file_.get(), static_cast<uid_t>(-1), static_cast<gid_t>(*group)) != 0)
    return system_error(path_, "cannot be given to the group", "be a member of it (usermod -aG)");
  if (::fchmod(file_.get(), group ? 0440 : 0400) != 0)
    return system_error(path_, "cannot be made readable", another_name);
  return {};
}

Result<void> SharedMemory::announce() {
  NameLock lock(path_);
  if (const auto locked = lock.take(path_); !locked) return locked.error();
  if (const auto removed = remove_stale(path_); !removed) return removed.error();
  const std::string here = "/proc/self/fd/" + std::to_string(file_.get());
  named_ = ::linkat(AT_FDCWD, here.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW) == 0;
  if (!named_) return system_error(path_, "cannot be made", another_name);
  return {};
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : path_(std::move(other.path_)), file_(std::move(other.file_)),
      memory_(std::exchange(other.memory_, nullptr)), bytes_(other.bytes_), locked_(other.locked_),
      named_(std::exchange(other.named_, false)) {}

SharedMemory::~SharedMemory() {
  if (memory_ != nullptr) ::munmap(memory_, bytes_);
  if (!named_) return;
  const UniqueFd there = look_at(path_);
  if (there.is_open() && is_same(there.get(), file_.get())) ::unlink(path_.c_str());
}

} // namespace nendo::publish
