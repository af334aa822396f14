#pragma once
// A shared-memory object that this process writes and other processes map for reading.

#include <cstddef>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

#include "publish/record_ring.hpp"

namespace nendo::publish {

class SharedMemory {
public:
  /// Makes zeroed memory that has no name yet. All pages are present and, if allowed, locked, so
  /// that writing never waits. This user can read it, and so can `group`, if given. No reader can
  /// write it. Errors: failed (no space), no_permission (this user is not in the group).
  static Result<SharedMemory> create(const std::string& name, std::size_t bytes,
                                     const std::optional<unsigned>& group);
  /// Gives the memory the name /dev/shm/nendo-`name`, with its present contents. Replaces a segment
  /// that a crashed run left, but nothing else. If several runs want the name at once, one gets it.
  /// Errors: failed (another run has the name, or the file is no segment), no_permission (it
  /// belongs to another user).
  Result<void> announce();
  /// Removes the name, if it still belongs to this memory. Processes that have mapped the memory
  /// keep it.
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;

  /// Returns the memory, which is aligned to a page.
  AtomicWord* words() const noexcept { return static_cast<AtomicWord*>(memory_); }
  std::size_t bytes() const noexcept { return bytes_; }
  /// Returns true if the pages cannot be swapped out.
  bool is_locked() const noexcept { return locked_; }

private:
  SharedMemory(std::string path, UniqueFd file, std::size_t bytes)
      : path_(std::move(path)), file_(std::move(file)), bytes_(bytes) {}
  Result<void> lay_out(const std::optional<unsigned>& group);

  std::string path_;
  UniqueFd file_; ///< its lock shows that the writer is alive
  void* memory_ = nullptr;
  std::size_t bytes_;
  bool locked_ = false;
  bool named_ = false;
};

} // namespace nendo::publish
