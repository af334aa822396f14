#include "openxr/segment_follower.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/base/shared_name.hpp>

namespace nendo::openxr {

void SegmentFollower::close() noexcept {
  for (std::size_t slot = 0; slot < slots; ++slot) {
    Mapping& mapping = mappings_.at(slot);
    if (mapping.base != nullptr) ::munmap(mapping.base, mapping.bytes);
    mapping = {};
  }
}

bool SegmentFollower::set_name(const char* name) noexcept {
  if (!is_shared_name(name)) return false;
  std::snprintf(path_.data(), path_.size(), "/dev/shm/nendo-%s", name);
  return true;
}

void SegmentFollower::unmap_unused() noexcept {
  for (std::size_t slot = 0; slot < slots; ++slot) {
    Mapping& mapping = mappings_.at(slot);
    if (slot == mappings_.newest() || mapping.base == nullptr || !mappings_.is_free(slot)) continue;
    ::munmap(mapping.base, mapping.bytes);
    mapping = {};
  }
}

/// Maps the file of that name into a free slot. No link is followed, and a pipe is not waited for.
SegmentState SegmentFollower::map(std::size_t slot) noexcept {
  const int file = ::open(path_.data(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) {
    error_ = errno;
    return error_ == ENOENT ? SegmentState::missing : SegmentState::refused;
  }
  struct stat status{};
  SegmentState state = SegmentState::unusable;
  if (::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    device_ = status.st_dev;
    file_ = status.st_ino;
    const auto bytes = static_cast<std::size_t>(status.st_size);
    void* const base = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file, 0);
    if (base != MAP_FAILED) {
      mappings_.at(slot) = {SegmentView(base, bytes), base, bytes};
      state = mappings_.at(slot).view.is_usable() ? SegmentState::mapped : SegmentState::unusable;
    }
  }
  ::close(file);
  return state;
}

SegmentState SegmentFollower::look() noexcept {
  if (path_[0] == '\0') return state_;
  unmap_unused();
  struct stat status{};
  const bool is_there = ::lstat(path_.data(), &status) == 0;
  if (is_there && status.st_dev == device_ && status.st_ino == file_) return state_;
  std::size_t slot = 0;
  while (slot < slots && !mappings_.is_free(slot))
    ++slot;
  if (slot == slots) return state_; // readers still use the others; look again later
  device_ = 0;
  file_ = 0;
  state_ = map(slot);
  // Without a name the segment is over, or another run is about to take the name.
  mappings_.publish(slot);
  return state_;
}

bool SegmentFollower::read(std::size_t side, std::int64_t now_ns, PublishedHand& hand) noexcept {
  const std::size_t slot = mappings_.acquire();
  const bool is_read = mappings_[slot].view.read(side, now_ns, hand);
  mappings_.release(slot);
  return is_read;
}

} // namespace nendo::openxr
