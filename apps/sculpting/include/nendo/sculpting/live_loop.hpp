#pragma once
// The entry point for programs that embed Nendo: gloves shape a model on a separate thread, as in
// `nendo run`.
//
//   auto live = nendo::sculpting::LiveLoop::begin("bust.obj");
//   if (!live) return fail(live.error());
//   while (!is_over())
//     if (live->update()) draw(live->frame(), live->vertices());
//   save(live->finish());

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/realtime.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/sculpting/open_hand.hpp>

namespace nendo::sculpting {

struct LiveOptions {
  /// The GLOVE of each hand for driver::open_glove(). Empty: no such hand; both empty: the
  /// machine's gloves, or two simulated hands.
  std::string left, right;
  CalibrationOptions calibration{}; ///< the wearers' calibrations
  flow::Mode mode = flow::Mode::type1;
  /// The longest side of the model on the stage, within model_size_range_m. Nothing:
  /// usual_size_m().
  std::optional<double> model_size_m{};
  /// The fingertips' radius on the stage, within flow::setting::radius. Nothing: usual_supports().
  std::optional<double> radius_m{};
  flow::PaceOptions pace{};         ///< 90 Hz
  flow::RealtimeOptions realtime{}; ///< real-time rights of the loop's thread
  hand::FilterOptions filter = flow::usual_settings().filter; ///< no filter; closes pinches
  std::optional<std::size_t> undo_bytes{}; ///< max undo memory; nothing: deform::half_of_memory()
  driver::GloveContext context{};          ///< the context for driver::open_glove()
};

/// Owns the gloves, the loop and its thread. For one thread at a time. For other rings, sinks or
/// logs, use flow::DeformLoop.
class NENDO_API LiveLoop {
public:
  /// Opens the gloves, waits for a sample from each, places the hands at the model, and starts the
  /// loop. Blocks for some seconds. Errors: usage (an invalid option), those of open_glove(),
  /// find_wearer() and make_loop().
  static Result<LiveLoop> begin(deform::Mesh model, const LiveOptions& options = {});
  /// Does the same with a model file. Further error: bad_input (the file).
  static Result<LiveLoop> begin(const std::string& model_file, const LiveOptions& options = {});
  ~LiveLoop(); ///< stops the loop and the gloves
  LiveLoop(LiveLoop&& other) noexcept;
  LiveLoop& operator=(LiveLoop&& other) noexcept;

  /// Takes the newest frame, and returns whether it is new since the last call. Call it often: it
  /// also prepares undos. Never waits for the loop.
  bool update();
  /// Returns the frame of the last update(), valid until the next one.
  const flow::Frame& frame() const noexcept;
  /// Returns the frame's vertices in the order of model(), 3 by #vertices in model units. Valid
  /// until the next call.
  const deform::Points& vertices();
  /// Returns the loaded model.
  const deform::Mesh& model() const noexcept;

  /// Sends a command, such as a flow::Request, flow::ChangeSettings or flow::WristMove. The loop
  /// takes it at the beginning of its next tick. Errors: bad_input (invalid settings), usage (a
  /// command that loops do not execute), failed (the command queue is full).
  Result<void> ask(const flow::Command& command);
  /// Returns the last requested settings.
  const flow::LoopSettings& settings() const noexcept;

  /// Returns whether all gloves are recordings that have ended, and the loop has taken all samples.
  bool has_ended() const noexcept;
  std::span<const OpenHand> hands() const noexcept; ///< left first; the loop drains their rings
  /// Returns messages for the user, such as found calibrations and refused rights.
  const std::vector<std::string>& notes() const noexcept;

  /// Stops the loop and the gloves, and returns the shaped model. Afterwards, only stats(),
  /// model(), notes() and frame() may be called. Allocates.
  deform::Mesh finish();
  const flow::LoopStats& stats() const noexcept; ///< after finish()

private:
  struct Parts;
  explicit LiveLoop(std::unique_ptr<Parts> parts) noexcept;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::sculpting
