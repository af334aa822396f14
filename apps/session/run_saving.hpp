#pragma once
// Saving while a run goes on, without a pause of its loop.

#include <string>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/deform_loop.hpp>

#include "session/run_recording.hpp"

namespace nendo::session {

/// Saves several times a second at most, however often it is asked for.
class RunSaving {
public:
  /// Saved shapes are named after `out` and numbered. `model` and `recorder` must outlive this.
  RunSaving(std::string out, const deform::Mesh& model, RunRecorder& recorder);

  /// flow::SaveShape and flow::SaveRecording wait for save(); other commands change nothing.
  void add(const flow::Command& command) noexcept;
  /// Whether anything waits.
  bool is_due() const noexcept { return shape_ || recording_; }
  /// Whether anything waits, and the last save() was long enough ago.
  bool is_due_now() const noexcept { return is_due() && HostClock::now() >= next_; }
  /// Saves what waits, the shape as the frame at the front has it. Blocks while it writes. Returns
  /// what became of it, in words for people.
  std::string save(flow::DeformLoop& loop);

private:
  std::string save_shape(flow::DeformLoop& loop);
  std::string save_recording();

  std::string out_;
  const deform::Mesh& model_;
  RunRecorder& recorder_;
  int saved_ = 0;
  bool shape_ = false;
  bool recording_ = false;
  HostTime next_{};
};

} // namespace nendo::session
