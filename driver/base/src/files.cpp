#include <nendo/base/files.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace nendo {
namespace {

namespace fs = std::filesystem;

std::string why(int error_number) {
  return std::generic_category().message(error_number);
}

std::string size_text(std::uint64_t bytes) {
  constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
  return bytes % (1024 * mebibyte) == 0 ? std::to_string(bytes / 1024 / mebibyte) + " GiB"
                                        : std::to_string(bytes / mebibyte) + " MiB";
}

/// A name that no other process or thread uses. Not mkstemp: its 0600 would override the umask.
fs::path temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> count{0};
  fs::path name = target.parent_path() / ".nendo";
  for (const unsigned part : {static_cast<unsigned>(::getpid()), count++})
    name += "." + std::to_string(part);
  name += ".tmp";
  return name;
}

/// 0, or the error number of the step that failed.
int write_and_rename(const fs::path& temporary, const fs::path& target, std::string_view contents) {
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.is_open()) return errno;
  const bool done = write_all(file.get(), std::as_bytes(std::span(contents))) &&
                    ::fsync(file.get()) == 0 && file.close() &&
                    ::rename(temporary.c_str(), target.c_str()) == 0;
  if (done) return 0;
  const int error_number = errno;
  ::unlink(temporary.c_str());
  return error_number;
}

} // namespace

bool Descriptor::close() noexcept {
  const int fd = std::exchange(fd_, -1);
  return fd < 0 || ::close(fd) == 0;
}

bool write_all(int fd, std::span<const std::byte> rest) noexcept {
  while (!rest.empty()) {
    const ssize_t written = ::write(fd, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    rest = rest.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

void sync_folder_of(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.is_open()) ::fsync(opened.get());
}

Result<OpenFile> open_file(const fs::path& path, std::string_view kind) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, path.string() + ": " + what};
  };
  // O_NONBLOCK: opening a pipe that nobody writes to would wait for ever.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) return bad("cannot be opened: " + why(errno));
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return bad("cannot be read: " + why(errno));
  if (!S_ISREG(info.st_mode))
    return bad("is not a regular file; name a " + std::string(kind) + " file");
  return OpenFile{std::move(file), static_cast<std::uint64_t>(info.st_size)};
}

Result<std::string> read_file(const fs::path& path, std::uint64_t most_bytes,
                              std::string_view kind) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, path.string() + ": " + what};
  };
  const auto too_large = [&] {
    return bad("is larger than " + size_text(most_bytes) + ", so it is no " + std::string(kind));
  };
  const auto opened = open_file(path, kind);
  if (!opened) return opened.error();
  const Descriptor& file = opened->file;
  const std::uint64_t size = opened->size;
  if (size > most_bytes) return too_large();
  std::string contents(size + 1, '\0'); // one more than is there: its end is seen in one turn
  std::size_t filled = 0;
  for (;;) {
    const ssize_t got = ::read(file.get(), contents.data() + filled, contents.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return bad("cannot be read: " + why(errno));
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
    if (filled > most_bytes) return too_large();
    // Files that grow, and those of /proc, are longer than they said.
    if (filled == contents.size())
      contents.resize(std::min(2 * contents.size(), static_cast<std::size_t>(most_bytes) + 1));
  }
  contents.resize(filled);
  return contents;
}

Result<void> replace_file(const fs::path& path, std::string_view contents) {
  const auto failed = [&](const std::string& what) {
    return Error{Errc::failed, path.string() + ": " + what};
  };
  const fs::path target = target_of(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return failed("is not a regular file; name another");
  const int error_number = write_and_rename(temporary_beside(target), target, contents);
  if (error_number != 0) {
    return failed("cannot be written: " + why(error_number) +
                  "; make room or choose a folder that you may write to");
  }
  sync_folder_of(target);
  return {};
}

fs::path target_of(const fs::path& path) {
  std::error_code missing;
  fs::path target = fs::canonical(path, missing);
  return missing ? path : target;
}

} // namespace nendo
