#pragma once
// A BVH recording on a disk. How many frames there will be is not known at the beginning, and a
// crash or a full disk may end the recording. The file is therefore readable at any time: frames
// are written whole, and the count at the head of the file is written over after them, never
// before.
//
// The recording grows as FILE.part and gets its name at the end. So the file that had the name
// before stays until the recording is whole, and what was recorded before a crash stays in
// FILE.part, which nothing here writes over. A crash of the program loses the frames that were not
// flushed; a crash of the machine also loses those that the kernel had not written yet.

#include <cstdint>
#include <filesystem>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/hand/bvh.hpp>

namespace nendo::hand {

/// A BVH file that is being written. Its functions block as long as the disk does.
class NENDO_API BvhFile {
public:
  /// Creates FILE.part, without frames. Errors: usage (a rate that is not above 0 and at most 1e6,
  /// a skeleton that is not finite), failed (the file cannot be written or is not a regular file,
  /// or FILE.part exists).
  static Result<BvhFile> create(const std::filesystem::path& path, const HandSkeleton& skeleton,
                                double rate_hz);

  BvhFile(BvhFile&& other) noexcept;
  BvhFile& operator=(BvhFile&&) = delete;
  /// Closes the file. Without finish(), the flushed frames stay in FILE.part; a FILE.part without
  /// any frame is removed.
  ~BvhFile();

  /// Takes the next frame and keeps it until flush(). Fails with bad_input if the pose is not
  /// finite; that frame is left out.
  Result<void> add(const HandPose& pose);
  /// Hands the kept frames to the system, then the count. Fails with failed (disk full, ...);
  /// frames that were not wholly written are then removed, and the message says where the others
  /// are.
  Result<void> flush();
  /// Flushes, syncs and gives the file its name. Must be called once, as the last call. Error:
  /// failed.
  Result<void> finish();

  /// Returns the number of flushed frames.
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
