#pragma once
// A shared-memory object of this process's: written here, mapped for reading by others.

#include <cstddef>
#include <optional>
#include <string>

#include <nendo/base/descriptor.hpp>
#include <nendo/base/result.hpp>
#include <nendo/publish/record_ring.hpp>

namespace nendo::publish {

class SharedMemory {
public:
  /// Zeros without a name yet, in memory that is already there and, if allowed, locked, so that
  /// writing it never waits. Readable by this user and, if `group` is one, by that group; writable
  /// by nobody who opens it. Errors: failed (no room), no_permission (a group that this user is not
  /// in).
  static Result<SharedMemory> create(const std::string& name, std::size_t bytes,
                                     const std::optional<unsigned>& group);
  /// Shows it as /dev/shm/nendo-`name`, with what is in it by now. What a run that crashed left
  /// there is replaced, anything else is not; of several runs that want the name at once one gets
  /// it. Errors: failed (another run's, no segment at all), no_permission (another user's).
  Result<void> announce();
  /// Takes the name away, if it still leads here; who has mapped the memory keeps it.
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;

  /// Aligned to a page.
  AtomicWord* words() const noexcept { return static_cast<AtomicWord*>(memory_); }
  std::size_t bytes() const noexcept { return bytes_; }
  /// Its pages may not be swapped out.
  bool is_locked() const noexcept { return locked_; }

private:
  SharedMemory(std::string path, Descriptor file, std::size_t bytes)
      : path_(std::move(path)), file_(std::move(file)), bytes_(bytes) {}
  Result<void> lay_out(const std::optional<unsigned>& group);

  std::string path_;
  Descriptor file_; ///< whose lock says that the writer lives
  void* memory_ = nullptr;
  std::size_t bytes_;
  bool locked_ = false;
  bool named_ = false;
};

} // namespace nendo::publish
