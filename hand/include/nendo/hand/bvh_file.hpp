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

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

// A hand's motion as text in the Biovision hierarchy format (BVH), which animation programs read.
// Only text is made here; BvhFile writes it to a disk.
//
// - Lengths are in centimetres, as most readers take them, and angles in degrees. The axes are
//   OpenXR's.
// - The ROOT is the wrist. Every other joint is a JOINT, in OpenXR's order, and every tip an End
//   Site. The palm is left out, because it is fixed to the wrist and nothing turns at it.
// - Names are OpenXR's followed by the hand, as the OpenXR specification advises: wrist_R,
//   index_proximal_L.
// - With all rotations zero the hand is the flat hand of JointAngles{}, whose bones are the
//   OFFSETs: the hierarchy holds the rest shape. A joint's OpenXR orientation is therefore its BVH
//   orientation times its orientation in the flat hand.
// - Channels are "Yrotation Zrotation Xrotation", that is R = Ry Rz Rx. A finger spreads about Y
//   and bends about X, so its channels are its joint's angles. This order is singular where Z is 90
//   degrees, to which no finger can turn. With X in the middle it would be singular at a
//   right-angled bend.
class NENDO_API BvhFormat {
public:
  static constexpr double units_per_metre = 100.0;
  /// The width of a frame count. Blanks behind it fill the width, so that it can be written over.
  static constexpr std::size_t count_width = 12;

  explicit BvhFormat(const HandSkeleton& skeleton);

  /// Returns the text from HIERARCHY to the line before MOTION.
  std::string hierarchy() const;
  /// Returns the lines MOTION, Frames and Frame Time. `rate_hz` must be above 0.
  static std::string motion_head(std::uint64_t frames, double rate_hz);
  static constexpr std::size_t count_place = sizeof "MOTION\nFrames: " - 1;
  /// Returns the frame count, padded to its whole width.
  static std::string count_text(std::uint64_t frames);

  /// Appends a line to `text`: where the wrist is and how all joints are turned, to six decimals.
  /// `pose` must be one of the skeleton's. Returns false and appends nothing if any of the numbers
  /// would not be finite.
  [[nodiscard]] bool append_frame(const HandPose& pose, std::string& text) const;

private:
  void append_joint(Joint joint, int depth, std::string& text) const;

  Side side_;
  HandPose rest_; ///< flat, at the origin
};

/// A BVH file that is being written. Its functions block as long as the disk does.
class NENDO_API BvhFile {
public:
  /// Creates FILE.part, without frames. Errors: usage (a rate that is not above 0 and at most 1e6,
  /// a skeleton that is not finite), failed (the file cannot be written or is not a regular file,
  /// or FILE.part exists).
  static Result<BvhFile> create(const std::filesystem::path& path, const HandSkeleton& skeleton,
                                double rate_hz);

  BvhFile(BvhFile&& other) noexcept = default;
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

  std::uint64_t frames() const noexcept { return frames_; }

private:
  BvhFile(std::filesystem::path target, std::filesystem::path part, UniqueFd fd, BvhFormat format);
  Result<void> begin(double rate_hz);
  Error failure(int error_number) const;

  std::filesystem::path target_;
  std::filesystem::path part_;
  UniqueFd fd_;
  BvhFormat format_;
  std::string pending_;
  std::uint64_t pending_frames_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t size_ = 0; ///< bytes up to the end of the last whole frame
  std::uint64_t count_at_ = 0;
};

} // namespace nendo::hand
