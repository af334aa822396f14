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

/// A name that no other thread and no other process of this system uses; but one that was killed
/// may have left it, or one of another container with the same number.
fs::path temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> count{0};
  fs::path name = target.parent_path() / ".nendo";
  for (const unsigned part : {static_cast<unsigned>(::getpid()), count++})
    name += "." + std::to_string(part);
  name += ".tmp";
  return name;
}

// Not mkstemp: its 0600 would override the umask.
UniqueFd new_temporary(const fs::path& target, fs::path& name) {
  constexpr int max_leftovers = 100;
  for (int turn = 0;; ++turn) {
    name = temporary_beside(target);
    UniqueFd file(::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.is_open() || errno != EEXIST || turn == max_leftovers) return file;
  }
}

} // namespace

bool UniqueFd::close() noexcept {
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
  const UniqueFd opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.is_open()) ::fsync(opened.get());
}

Result<OpenFile> open_file(const fs::path& path, std::string_view kind) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, path.string() + ": " + what};
  };
  // O_NONBLOCK: opening a pipe without a writer would wait for ever.
  UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) return bad("cannot be opened: " + why(errno));
  struct stat info{};
  if (::fstat(file.get(), &info) != 0) return bad("cannot be read: " + why(errno));
  if (S_ISDIR(info.st_mode))
    return bad("is a folder and not a regular file; name a " + std::string(kind) + " file");
  if (!S_ISREG(info.st_mode))
    return bad("is not a regular file; name a " + std::string(kind) + " file");
  return OpenFile{std::move(file), static_cast<std::uint64_t>(info.st_size)};
}

Result<std::string> read_file(const fs::path& path, std::uint64_t max_bytes,
                              std::string_view kind) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, path.string() + ": " + what};
  };
  const auto too_large = [&] {
    return bad("is larger than " + size_text(max_bytes) + ", so it is no " + std::string(kind));
  };
  const auto opened = open_file(path, kind);
  if (!opened) return opened.error();
  const UniqueFd& file = opened->file;
  const std::uint64_t size = opened->size;
  if (size > max_bytes) return too_large();
  std::string contents(size + 1, '\0'); // one more than is there: its end is seen in one turn
  std::size_t filled = 0;
  for (;;) {
    const ssize_t got = ::read(file.get(), contents.data() + filled, contents.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return bad("cannot be read: " + why(errno));
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
    if (filled > max_bytes) return too_large();
    // Files that grow, and those of /proc, are longer than they said.
    if (filled == contents.size())
      contents.resize(std::min(2 * contents.size(), static_cast<std::size_t>(max_bytes) + 1));
  }
  contents.resize(filled);
  return contents;
}

FileReplacement::FileReplacement(fs::path path, fs::path target)
    : path_(std::move(path)), target_(std::move(target)) {}

FileReplacement::FileReplacement(FileReplacement&& other) noexcept
    : path_(std::move(other.path_)), target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})), file_(std::move(other.file_)),
      size_(other.size_) {}

FileReplacement::~FileReplacement() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Error FileReplacement::failure(int error_number) const {
  return {Errc::failed, path_.string() + ": cannot be written: " + why(error_number) +
                            "; free some space or choose a folder that you may write to"};
}

Result<FileReplacement> FileReplacement::begin(const fs::path& path) {
  FileReplacement begun(path, target_of(path));
  std::error_code ignored;
  const fs::file_status status = fs::status(begun.target_, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return Error{Errc::failed, path.string() + ": is not a regular file; name another"};
  fs::path temporary;
  begun.file_ = new_temporary(begun.target_, temporary);
  if (!begun.file_.is_open()) return begun.failure(errno);
  begun.temporary_ = std::move(temporary);
  const auto mode = static_cast<mode_t>(status.permissions() & fs::perms::all);
  if (fs::exists(status) && ::fchmod(begun.file_.get(), mode) != 0) return begun.failure(errno);
  return begun;
}

Result<void> FileReplacement::write(std::span<const std::byte> bytes) {
  if (!write_all(file_.get(), bytes)) return failure(errno);
  size_ += bytes.size();
  return {};
}

Result<void> FileReplacement::sync() {
  if (::fsync(file_.get()) != 0 || !file_.close()) return failure(errno);
  return {};
}

Result<void> FileReplacement::finish() {
  if (file_.is_open())
    if (const auto synced = sync(); !synced) return synced.error();
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return failure(errno);
  temporary_.clear();
  sync_folder_of(target_);
  return {};
}

Result<void> replace_file(const fs::path& path, std::string_view contents) {
  auto file = FileReplacement::begin(path);
  if (!file) return file.error();
  if (const auto written = file->write(contents); !written) return written.error();
  return file->finish();
}

fs::path target_of(const fs::path& path) {
  std::error_code missing;
  fs::path target = fs::canonical(path, missing);
  if (!missing) return target;
  constexpr int max_links = 40; // as many as the kernel follows
  target = path;
  for (int links = 0; links < max_links; ++links) { // what the last link names is not there yet
    std::error_code no_link;
    const fs::path next = fs::read_symlink(target, no_link);
    if (no_link) return target;
    target = target.parent_path() / next;
  }
  return path;
}

} // namespace nendo
