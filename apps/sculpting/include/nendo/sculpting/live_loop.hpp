#pragma once
// Gloves shape a model in a thread of their own, as in `nendo run`: the entrance for programs that
// embed Nendo.
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
  /// GLOVE for each hand, as driver::open_glove() takes it. Empty: no such hand; both empty: the
  /// gloves that this machine has, or two simulated hands if it has none.
  std::string left, right;
  CalibrationOptions calibration{}; ///< the wearers
  flow::Mode mode = flow::Mode::type1;
  /// The longest side of the model on the stage, within model_size_range_m. Nothing:
  /// usual_size_m().
  std::optional<double> model_size_m{};
  /// How far a fingertip shapes, on the stage, within flow::setting::radius. Nothing:
  /// usual_supports().
  std::optional<double> radius_m{};
  flow::PaceOptions pace{};                                   ///< 90 Hz
  flow::RealtimeOptions realtime{};                           ///< the rights of the loop's thread
  hand::FilterOptions filter = flow::usual_settings().filter; ///< off, but pinches are closed
  std::optional<std::size_t> undo_bytes{};                    ///< nothing: deform::half_of_memory()
  driver::GloveContext context{}; ///< the context for driver::open_glove()
};

/// Owns the gloves, the loop and its thread. Asking thread: whichever uses it, one at a time.
/// For other rings, sinks or logs, make a flow::DeformLoop.
class NENDO_API LiveLoop {
public:
  /// Opens the gloves, waits for a sample from each, places the hands at the model, and starts the
  /// loop. Blocks for some seconds. Errors: usage (an option), those of open_glove(),
  /// find_wearer() and make_loop().
  static Result<LiveLoop> begin(deform::Mesh model, const LiveOptions& options = {});
  /// Does the same with the model of a file. Further error: bad_input (the file).
  static Result<LiveLoop> begin(const std::string& model_file, const LiveOptions& options = {});
  ~LiveLoop(); ///< stops the loop and the gloves
  LiveLoop(LiveLoop&& other) noexcept;
  LiveLoop& operator=(LiveLoop&& other) noexcept;

  /// Takes the newest frame, and returns whether there is one since the last time. Call it often:
  /// it also makes what undos need. Never waits for the loop.
  bool update();
  /// Returns the frame that update() took. It stays as it is until the next update().
  const flow::Frame& frame() const noexcept;
  /// Returns the frame's vertices in the order of model(), 3 by #vertices in model units. They stay
  /// as they are until the next call.
  const deform::Points& vertices();
  /// Returns the model as it was loaded, and its faces.
  const deform::Mesh& model() const noexcept;

  /// Sends a command: a flow::Request such as undo, a flow::ChangeSettings, a flow::WristMove.
  /// The loop takes it at the beginning of its next tick. Errors: bad_input (settings that cannot
  /// be used), usage (a command that no loop executes), failed (the loop is too far behind).
  Result<void> ask(const flow::Command& command);
  /// Returns the last requested settings, for flow::ChangeSettings.
  const flow::LoopSettings& settings() const noexcept;

  /// Returns whether all gloves are recordings that have ended, and the loop has taken all of them.
  bool has_ended() const noexcept;
  std::span<const OpenHand> hands() const noexcept; ///< left first; their rings are the loop's
  /// Returns notices for the user: found calibrations, and refused rights.
  const std::vector<std::string>& notes() const noexcept;

  /// Stops the loop and the gloves, and returns the model as the hands left it. Only stats(),
  /// model(), notes() and frame() may be called afterwards. Allocates.
  deform::Mesh finish();
  const flow::LoopStats& stats() const noexcept; ///< after finish()

private:
  struct Parts;
  explicit LiveLoop(std::unique_ptr<Parts> parts) noexcept;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::sculpting
