#pragma once
// Writes a BVH recording to disk. The number of frames is not known in advance, and a crash or a
// full disk may end the recording. The file is therefore valid at any time: whole frames are
// written first, and then the frame count in the header is overwritten.
//
// The recording is written to FILE.part, which is renamed at the end. An existing FILE thus stays
// until the recording is complete, and after a crash the frames stay in FILE.part, which is never
// overwritten. A crash of the program loses frames that were not flushed; a crash of the machine
// also loses frames that the kernel had not written yet.

#include <cstdint>
#include <filesystem>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// Formats a hand's motion as text in the Biovision hierarchy format (BVH), which animation
/// programs read. BvhFile writes the text to disk.
///
/// - Lengths are in centimetres, as most readers expect, and angles in degrees. The axes are
///   OpenXR's.
/// - The ROOT is the wrist. Every other joint is a JOINT, in OpenXR's order, and every tip an End
///   Site. The palm is omitted, because it is fixed to the wrist.
/// - Names are OpenXR's followed by the hand, as the OpenXR specification advises: wrist_R,
///   index_proximal_L.
/// - With all rotations zero, the hand is the flat hand of JointAngles{}, whose bones are the
///   OFFSETs. A joint's OpenXR orientation is therefore its BVH orientation times its orientation
///   in the flat hand.
/// - Channels are "Yrotation Zrotation Xrotation", that is R = Ry Rz Rx. A finger spreads about Y
///   and bends about X, so its channels are its joint's angles. This order is singular at Z = 90
///   degrees, which no finger reaches. With X in the middle, it would be singular at a bend of 90
///   degrees.
class NENDO_API BvhFormat {
public:
  static constexpr double units_per_metre = 100.0;
  /// The field width of the frame count, padded with blanks so that it can be overwritten.
  static constexpr std::size_t count_width = 12;

  explicit BvhFormat(const HandSkeleton& skeleton);

  /// Returns the text from HIERARCHY up to MOTION, exclusive.
  std::string hierarchy() const;
  /// Returns the lines MOTION, Frames and Frame Time. `rate_hz` must be above 0.
  static std::string motion_head(std::uint64_t frames, double rate_hz);
  static constexpr std::size_t count_place = sizeof "MOTION\nFrames: " - 1;
  /// Returns the frame count, padded to its whole width.
  static std::string count_text(std::uint64_t frames);

  /// Appends a frame line to `text`: the wrist's position and all joint rotations, with six
  /// decimals. `pose` must come from this skeleton. Returns false and appends nothing if a number
  /// is not finite.
  [[nodiscard]] bool append_frame(const HandPose& pose, std::string& text) const;

private:
  void append_joint(Joint joint, int depth, std::string& text) const;

  Side side_;
  HandPose rest_; ///< the flat hand, at the origin
};

/// A BVH file that is being written. Its functions block on file I/O.
class NENDO_API BvhFile {
public:
  /// Creates FILE.part, without frames. Errors: usage (a rate outside 0 < rate <= 1e6, a skeleton
  /// that is not finite), failed (the file cannot be written or is not a regular file, or FILE.part
  /// exists).
  static Result<BvhFile> create(const std::filesystem::path& path, const HandSkeleton& skeleton,
                                double rate_hz);

  BvhFile(BvhFile&& other) noexcept = default;
  BvhFile& operator=(BvhFile&&) = delete;
  /// Closes the file. Without finish(), the flushed frames stay in FILE.part; a FILE.part without
  /// any frame is removed.
  ~BvhFile();

  /// Buffers the next frame until flush(). Fails with bad_input if the pose is not finite; that
  /// frame is omitted.
  Result<void> add(const HandPose& pose);
  /// Writes the buffered frames, then the count. Fails with failed (disk full, ...); incomplete
  /// frames are then removed, and the message names the file that has the others.
  Result<void> flush();
  /// Flushes, syncs and renames the file. Must be called once, as the last call. Error: failed.
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
