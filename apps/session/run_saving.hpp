#pragma once
// Saves shapes, puppets and the recording in memory, during a run and at its end.

#include <cstdint>
#include <optional>
#include <string>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/deform_loop.hpp>

#include "session/run_options.hpp"
#include "session/run_recording.hpp"

namespace nendo::session {

/// Writes the shape to `out`, with `up` as the file's up axis, and notes on standard error what the
/// format cannot store. If that fails, as on a full disk, writes to the folder for temporary files,
/// so that the shape is not lost. Blocks. Error: failed, also if the shape is in the other folder,
/// which the message names.
Result<void> write_shape(const std::string& out, const deform::Mesh& shape, deform::UpAxis up);

/// Saves files, at most a few times per second.
class RunSaving {
public:
  /// Saved shapes are named after `options.out` and numbered. `recorder` must outlive this.
  RunSaving(const RunOptions& options, RunRecorder& recorder);

  /// Queues flow::SaveShape, flow::SaveRecording and flow::SavePuppet for save(). Ignores other
  /// commands.
  void add(const flow::Command& command) noexcept;
  /// Queues the shape for save() into this file, and so for each later flow::SaveShape.
  void add(const std::string& file);
  /// Returns whether a save is pending.
  bool is_due() const noexcept { return shape_ || recording_ || puppet_; }
  /// Returns whether a save is pending, and the last save() was long enough ago.
  bool is_due_now() const noexcept { return is_due() && HostClock::now() >= next_; }
  /// Saves all pending files, the shape from the newest frame. Blocks while it writes. Returns a
  /// message for the user with the results.
  Report save(flow::DeformLoop& loop);

  /// Returns whether the frame's shape differs from the first one that this has seen, and from the
  /// saved one.
  bool is_modified(const flow::Frame& frame);
  /// Returns the file of the last saved shape; empty: none.
  const std::string& saved() const noexcept { return saved_file_; }
  std::uint32_t saves() const noexcept { return saves_; } ///< the number of saved shapes

private:
  Report save_shape(flow::DeformLoop& loop);
  Report save_recording();
  Report save_puppet(const flow::DeformLoop& loop);

  std::string out_;
  deform::UpAxis up_;
  std::string model_; ///< the model's file
  PuppetPlace out_puppet_;
  RunRecorder& recorder_;
  int saved_ = 0;
  std::string chosen_;     ///< where the shape goes; empty: into the next free name
  std::string saved_file_; ///< the file of the last saved shape
  std::uint32_t saves_ = 0;
  struct Version {
    std::uint32_t model = 0;
    deform::BlockShape shape;
  };
  std::optional<Version> clean_; ///< the shape that is on the disk
  bool shape_ = false;
  bool recording_ = false;
  bool puppet_ = false;
  HostTime next_{};
};

} // namespace nendo::session
