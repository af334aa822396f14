#pragma once
// The frames of a take, one after another and without a clock. They come from a recording, whose
// loop runs again, or from a timeline of edited keys.

#include <optional>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::takes {

/// The puppet that makes the shape of a frame, on the frame's version of the model.
struct PlayedPuppet {
  std::shared_ptr<const puppet::Rig> rig;
  flow::SculptorOptions sculptor; ///< as of that frame
};

class FrameSource {
public:
  virtual ~FrameSource() = default;
  /// The axis that points up in the model's file, in whose axes meshes are written.
  deform::UpAxis up() const noexcept { return up_; }
  void set_up(deform::UpAxis up) noexcept { up_ = up; }
  /// Returns the model before the hands, in model units: the first one, or that of a version that
  /// the latest frame, or one before it, has (Frame::model).
  virtual const deform::Mesh& model(std::uint32_t version) const = 0;
  virtual const deform::BlockLayout&
  layout(std::uint32_t version) const = 0; ///< layout of its shapes
  /// Returns whether all frames are of the first version.
  virtual bool has_one_model() const { return true; }
  /// Returns the puppet of frame(), or of the first frame before next(); nothing if the hands touch
  /// the model.
  virtual std::optional<PlayedPuppet> puppet() const { return std::nullopt; }
  /// Returns the masks of fingertips (flow::LoopOptions::rig) as the take begins; null: none. A
  /// change of masks ends a stroke (Frame::rest_changes).
  virtual const puppet::Rig* masks() const { return nullptr; }
  virtual double rate_hz() const = 0;    ///< rate of the frames, as far as it is even
  virtual double duration_s() const = 0; ///< time_s() of the last frame
  /// Makes the next frame. Returns false if there is none. May block and allocate.
  virtual bool next() = 0;
  virtual const flow::Frame& frame() const = 0; ///< the latest; not before next()
  virtual double time_s() const = 0;            ///< time of the latest, since the take began
  /// Returns whether the hand of that side has angles of its own, by a calibration, or else an
  /// average hand's; nothing if that is not known, as of a timeline.
  virtual std::optional<bool> is_calibrated(Side) const { return std::nullopt; }
  /// Returns true while nothing was missing in the source, so that the frames equal the original
  /// ones.
  virtual bool is_exact() const { return true; }

private:
  deform::UpAxis up_ = deform::UpAxis::y;
};

} // namespace nendo::takes
