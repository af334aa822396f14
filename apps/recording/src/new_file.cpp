#include "new_file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include <nendo/base/files.hpp>

namespace nendo::recording {

Result<NewFile> NewFile::create(const std::filesystem::path& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  if (file.is_open()) return NewFile(path, std::move(file));
  if (errno == EEXIST)
    return Error{Errc::failed, path.string() + ": is there already, and no recording is written "
                                               "over; name another file or move it away"};
  return Error{Errc::failed, path.string() +
                                 ": cannot be made: " + std::generic_category().message(errno) +
                                 "; choose a folder that is there and that you may write to"};
}

NewFile::~NewFile() {
  if (provisional_) ::unlink(path_.c_str());
}

void NewFile::keep() {
  provisional_ = false;
  sync_folder_of(path_);
}

} // namespace nendo::recording
