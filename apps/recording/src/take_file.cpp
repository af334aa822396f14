#include "take_file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/base/files.hpp>

namespace nendo::recording {
namespace {

std::string last_error() {
  return std::generic_category().message(errno);
}

} // namespace

Result<NewFile> NewFile::create(const std::filesystem::path& path) {
  UniqueFd file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  if (file.is_open()) return NewFile(path, std::move(file));
  if (errno == EEXIST)
    return Error{Errc::failed, path.string() + ": is there already, and recordings are never "
                                               "overwritten; name another file or move it away"};
  return Error{Errc::failed, path.string() + ": cannot be made: " + last_error() +
                                 "; choose a folder that is there and that you may write to"};
}

NewFile::~NewFile() {
  if (provisional_) ::unlink(path_.c_str());
}

void NewFile::make_permanent() {
  provisional_ = false;
  sync_folder_of(path_);
}

Result<TakeFile> TakeFile::create(const std::filesystem::path& path,
                                  std::span<const std::byte> setup, std::uint32_t chunks,
                                  Kind kind) {
  auto created = NewFile::create(path);
  if (!created) return created.error();
  TakeFile file(*std::move(created), chunks, kind);
  if (const auto written = file.write(setup); !written) return written.error();
  if (kind == Kind::live) file.file_.make_permanent();
  return file;
}

Result<void> TakeFile::append(ChunkType type, std::span<const std::byte> payload) {
  if (failed_) return {};
  chunk_.clear();
  append_chunk(chunk_, type, chunks_, payload);
  ++chunks_;
  return write(chunk_);
}

Result<void> TakeFile::sync() {
  if (failed_) return {};
  if (::fdatasync(file_.fd()) != 0) return give_up(last_error(), "free some space");
  file_.make_permanent();
  return {};
}

Result<void> TakeFile::write(std::span<const std::byte> bytes) {
  if (!write_all(file_.fd(), bytes) || (kind_ == Kind::live && ::fdatasync(file_.fd()) != 0))
    return give_up(last_error(), "free some space");
  bytes_ += bytes.size();
  struct stat info{};
  if (::fstat(file_.fd(), &info) == 0 && info.st_nlink == 0)
    return give_up("the file or its folder was removed", "leave them alone");
  return {};
}

Error TakeFile::give_up(const std::string& reason, const std::string& remedy) {
  failed_ = true;
  const std::string& name = file_.path().string();
  if (!file_.is_permanent())
    return Error{Errc::failed, name + ": cannot be written: " + reason + "; " + remedy +
                                   " and try again: nothing of it was kept"};
  // What is half-written goes; should that fail, the chunk's checksum shows it.
  if (::ftruncate(file_.fd(), static_cast<off_t>(bytes_)) == 0) ::fdatasync(file_.fd());
  return Error{Errc::failed, name +
                                 ": recording has ended early, what was written until now is "
                                 "whole: " +
                                 reason + "; " + remedy + " before the next one"};
}

} // namespace nendo::recording
