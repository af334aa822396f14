#include "take_file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace nendo::recording {
namespace {

std::string why(int error_number) {
  return std::generic_category().message(error_number);
}

} // namespace

Result<Descriptor> create_file(const std::filesystem::path& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  if (file.is_open()) return file;
  if (errno == EEXIST)
    return Error{Errc::failed, path.string() + ": is there already, and no recording is written "
                                               "over; name another file or move it away"};
  return Error{Errc::failed, path.string() + ": cannot be made: " + why(errno) +
                                 "; choose a folder that is there and that you may write to"};
}

Result<TakeFile> TakeFile::create(const std::filesystem::path& path,
                                  std::span<const std::byte> setup, std::uint32_t chunks) {
  auto created = create_file(path);
  if (!created) return created.error();
  TakeFile file;
  file.path_ = path;
  file.file_ = *std::move(created);
  file.chunks_ = chunks;
  if (const auto written = file.write(setup); !written) return written.error();
  sync_folder_of(path);
  return file;
}

Result<void> TakeFile::append(driver::ChunkType type, std::span<const std::byte> payload) {
  if (failed_) return {};
  chunk_.clear();
  driver::append_chunk(chunk_, type, chunks_, payload);
  ++chunks_;
  return write(chunk_);
}

Result<void> TakeFile::sync() {
  if (failed_ || ::fdatasync(file_.get()) == 0) return {};
  return give_up(why(errno) + "; make room");
}

Result<void> TakeFile::write(std::span<const std::byte> bytes) {
  if (!write_all(file_.get(), bytes) || (syncs_each_ && ::fdatasync(file_.get()) != 0)) {
    const int error_number = errno;
    return give_up(why(error_number) + "; make room");
  }
  bytes_ += bytes.size();
  struct stat info {};
  if (::fstat(file_.get(), &info) == 0 && info.st_nlink == 0)
    return give_up("the file or its folder was removed; leave them alone");
  return {};
}

Error TakeFile::give_up(const std::string& reason) {
  failed_ = true;
  // What is half-written goes; should that fail, too, the chunk's checksum tells.
  if (::ftruncate(file_.get(), static_cast<off_t>(bytes_)) == 0) ::fdatasync(file_.get());
  return Error{Errc::failed, path_.string() +
                                 ": recording has ended early, what was written until "
                                 "now is whole: " +
                                 reason + " before the next one"};
}

} // namespace nendo::recording
