#pragma once
// A BVH recording on a disk. How many frames there will be is not known at the beginning, and the
// end may be a crash or a full disk, so the file is readable at any time: whole frames are written
// at once, and the count at its head is written over after them, never before.
//
// It grows as FILE.part and gets its name at the end. That loses least: what stood under the name
// stays until the recording is whole, and what was recorded before a crash stays in FILE.part,
// which nothing here writes over. A crash of the program loses what was not flushed; one of the
// machine also what the kernel had not written yet.

#include <cstdint>
#include <filesystem>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/hand/bvh.hpp>

namespace nendo::hand {

/// Its functions block as long as the disk does. Movable.
class BvhFile {
public:
  /// Begins FILE.part, without frames. Errors: usage (a rate that is not above 0 and at most
  /// 1e6, a skeleton that is not finite), failed (cannot be written, is no regular file, or
  /// FILE.part exists).
  static Result<BvhFile> create(const std::filesystem::path& path, const HandSkeleton& skeleton,
                                double rate_hz);

  BvhFile(BvhFile&& other) noexcept;
  BvhFile& operator=(BvhFile&&) = delete;
  /// Without finish() what was flushed stays in FILE.part; one without any frame is removed.
  ~BvhFile();

  /// The next frame, kept until flush(). Error: bad_input if it is not finite; it is left out.
  Result<void> add(const HandPose& pose);
  /// Gives whole frames to the system, then the count. Error: failed (disk full, ...); frames that
  /// were not wholly written are taken out again, and the message says where the others are.
  Result<void> flush();
  /// Flushes, syncs and gives the file its name. To be called once, as the last. Error: failed.
  Result<void> finish();

  /// Flushed ones.
  std::uint64_t frames() const noexcept { return frames_; }

private:
  BvhFile(std::filesystem::path target, std::filesystem::path part, int fd, BvhFormat format);
  Result<void> begin(double rate_hz);
  Error failure(int error_number) const;

  std::filesystem::path target_;
  std::filesystem::path part_;
  int fd_;
  BvhFormat format_;
  std::string pending_;
  std::uint64_t pending_frames_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t size_ = 0; ///< bytes up to the end of the last whole frame
  std::uint64_t count_at_ = 0;
};

} // namespace nendo::hand
