#pragma once
// Saves shapes and recordings: while a run continues, without a pause of its loop, and at its end.

#include <string>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/deform_loop.hpp>

#include "session/run_options.hpp"

namespace nendo::session {

/// Writes the shape to `out`, with the axis `up` of the file up, and notes on standard error what
/// such a file cannot keep. If that is impossible, on a full disk for example, it writes to the
/// folder for temporary files, so that the shape is not lost. Blocks. Error: failed, also if the
/// shape is in the other folder; the message says where.
Result<void> write_shape(const std::string& out, const deform::Mesh& shape,
                         deform::UpAxis up = deform::UpAxis::y);

/// Saves a few times per second at most, even if it is asked more often.
class RunSaving {
public:
  /// Saved shapes are named after `options.out` and numbered. `recorder` must outlive this.
  RunSaving(const RunOptions& options, RunRecorder& recorder);

  /// Takes note of flow::SaveShape, flow::SaveRecording and flow::SavePuppet for save(). Other
  /// commands change nothing.
  void add(const flow::Command& command) noexcept;
  /// Returns whether anything waits to be saved.
  bool is_due() const noexcept { return shape_ || recording_ || puppet_; }
  /// Returns whether anything waits to be saved and the last save() was long enough ago.
  bool is_due_now() const noexcept { return is_due() && HostClock::now() >= next_; }
  /// Saves what waits. The shape is that of the newest frame. Blocks while it writes. Returns a
  /// message for people that says what was saved.
  std::string save(flow::DeformLoop& loop);

private:
  std::string save_shape(flow::DeformLoop& loop);
  std::string save_recording();
  std::string save_puppet(const flow::DeformLoop& loop);

  std::string out_;
  deform::UpAxis up_;
  std::string model_; ///< its file
  PuppetPlace out_puppet_;
  RunRecorder& recorder_;
  int saved_ = 0;
  bool shape_ = false;
  bool recording_ = false;
  bool puppet_ = false;
  HostTime next_{};
};

} // namespace nendo::session
