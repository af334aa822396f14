#include "ros2/segment_reader.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace nendo::ros2 {
namespace {

const std::uint64_t* stage_at(const char* content) noexcept {
  return reinterpret_cast<const std::uint64_t*>(content);
}

template <class Content>
bool copy_content(const char* from, std::uint64_t number, Content& out) noexcept {
  if (!nendo_publish_holds(stage_at(from), number)) return false;
  nendo_publish_copy(&out, from, sizeof out);
  return nendo_publish_still_holds(stage_at(from), number) != 0;
}

} // namespace

SegmentReader::SegmentReader(UniqueFd file, const char* base, std::uint64_t bytes) noexcept
    : file_(std::move(file)), base_(base), bytes_(bytes) {
  nendo_publish_copy(&header_, base, sizeof header_);
}

SegmentReader::SegmentReader(SegmentReader&& other) noexcept
    : file_(std::move(other.file_)), base_(std::exchange(other.base_, nullptr)),
      bytes_(other.bytes_), header_(other.header_) {}

SegmentReader::~SegmentReader() {
  if (base_ != nullptr) ::munmap(const_cast<char*>(base_), bytes_);
}

Result<std::optional<SegmentReader>> SegmentReader::attach(const std::string& name) {
  const std::string path = "/dev/shm/nendo-" + name;
  UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!file.is_open() && errno == ENOENT) return std::optional<SegmentReader>();
  if (!file.is_open() && (errno == EACCES || errno == EPERM))
    return Error{Errc::no_permission,
                 path +
                     ": may not be read; run nendo-ros2 as the user of the run, or give the run "
                     "--to shm:" +
                     name + "?group=GROUP"};
  const Error refused{Errc::bad_input, path + ": is no segment of nendo, version 1"};
  struct stat status{};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) ||
      static_cast<std::uint64_t>(status.st_size) < sizeof(nendo_publish_header))
    return refused;
  const auto bytes = static_cast<std::uint64_t>(status.st_size);
  void* const base = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file.get(), 0);
  if (base == MAP_FAILED) return Error{Errc::failed, path + ": " + std::strerror(errno)};
  SegmentReader reader(std::move(file), static_cast<const char*>(base), bytes);
  if (!nendo_publish_is_usable(&reader.header_, bytes)) return refused;
  if (reader.has_ended()) return std::optional<SegmentReader>(); // what a killed run left
  return std::optional<SegmentReader>(std::move(reader));
}

bool SegmentReader::read(std::uint64_t number, HandsRecord& out) const noexcept {
  if (number == 0) return false;
  const std::uint64_t slot = number % header_.record_slots;
  if (!copy_content(base_ + header_.records_offset + slot * header_.record_stride, number,
                    out.record))
    return false;
  if (header_.states_offset == 0) {
    out.states = {};
    return true;
  }
  return copy_content(base_ + header_.states_offset + slot * header_.states_stride, number,
                      out.states);
}

bool SegmentReader::has_ended() const noexcept {
  struct flock lock{};
  lock.l_type = F_RDLCK;
  lock.l_whence = SEEK_SET;
  return nendo_publish_state(base_) == NENDO_PUBLISH_ENDED ||
         (::fcntl(file_.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type == F_UNLCK);
}

} // namespace nendo::ros2
