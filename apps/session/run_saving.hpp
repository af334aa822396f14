#pragma once
// Saves shapes, puppets and the recording in memory, during a run and at its end.

#include <string>

#include <nendo/deform/mesh_file.hpp>
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
  /// Returns whether a save is pending.
  bool is_due() const noexcept { return shape_ || recording_ || puppet_; }
  /// Returns whether a save is pending, and the last save() was long enough ago.
  bool is_due_now() const noexcept { return is_due() && HostClock::now() >= next_; }
  /// Saves all pending files, the shape from the newest frame. Blocks while it writes. Returns a
  /// message for the user with the results.
  std::string save(flow::DeformLoop& loop);

private:
  std::string save_shape(flow::DeformLoop& loop);
  std::string save_recording();
  std::string save_puppet(const flow::DeformLoop& loop);

  std::string out_;
  deform::UpAxis up_;
  std::string model_; ///< the model's file
  PuppetPlace out_puppet_;
  RunRecorder& recorder_;
  int saved_ = 0;
  bool shape_ = false;
  bool recording_ = false;
  bool puppet_ = false;
  HostTime next_{};
};

} // namespace nendo::session
