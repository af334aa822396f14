#pragma once
// Changes of a loop's settings, puppet, model and log. The asking thread prepares them; the loop
// applies them at the beginning of its next tick.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/job_offer.hpp>
#include <nendo/base/result.hpp>
#include <nendo/flow/prepared_change.hpp>

namespace nendo::flow {

/// The initial state of a loop or timeline, for its ChangeBroker and its ShapingCore.
struct CoreOptions {
  SculptorSetup setup; ///< without the additions of a puppet, masks or hands' bodies
  ShapingOptions shaping{};
  std::vector<Side> hands; ///< one or two, in the order of their control points
  std::size_t inputs = 1;  ///< the number of hands and layers
  std::shared_ptr<HandBodies> bodies;
  double units_per_metre = 1.0;
  /// A puppet that hands play, or masks and a mirror for their fingertips; null: neither.
  std::shared_ptr<const puppet::Rig> rig{};
  puppet::RigState rig_state{}; ///< the initial state of the puppet's player
  /// Further puppets for change_puppet(), numbered from 1.
  std::vector<std::shared_ptr<const puppet::Rig>> more_rigs{};
  std::size_t undo_max_bytes = 0; ///< UndoSpace::max_bytes for all versions together
};

/// Asking thread, which may be the loop's thread, except for the last two functions. The loop takes
/// all pending changes together.
class NENDO_API ChangeBroker {
public:
  /// Copies the model. `first`, if given, is the initial shape, in the blocks of the model's
  /// layout. Allocates.
  ChangeBroker(const deform::Mesh& model, const CoreOptions& options,
               const deform::BlockShape* first = nullptr);
  ~ChangeBroker();

  /// Returns whether the loop has not taken a change yet.
  bool is_changing();

  /// Prepares these settings. When the loop takes them, the current stroke ends, and the fingertips
  /// re-grab the same shape. Changes less than a second apart, and strokes between them, are one
  /// undo step. Settings equal to the last requested ones change nothing. Allocates. Error:
  /// bad_input (they are not compatible()); then nothing changes.
  Result<void> change_settings(const LoopSettings& settings);
  /// Return the last requested settings, and their sculptor options.
  const LoopSettings& settings() const noexcept { return setup().settings; }
  const SculptorOptions& sculptor_options() const noexcept { return setup().options; }
  const SculptorSetup& setup() const noexcept;
  /// Requests the change that an undo or a redo awaits (Frame::awaited): settings, a puppet, or a
  /// stored version of the model. Allocates. Errors, and then nothing changes: bad_input (no such
  /// puppet or version, or change_settings() refuses the settings); failed (another change of the
  /// model is pending: try again later).
  Result<void> change_to(const Awaited& awaited);

  /// Logs the input to `log` from a coming tick on; null: ends logging. That tick keeps the shape,
  /// and the hands re-grab; undo cannot go back before a log's beginning. Both logs must exist
  /// until take_state() returns a state. `like` is the shape of a recent frame: the tick copies
  /// only the blocks that differ from it.
  void change_log(InputLog* log, const deform::BlockShape& like);
  /// Returns the state at the log's beginning, or at its end, once for each change_log() that the
  /// loop has taken.
  std::optional<LoopState> take_state();

  // Changes of puppets, and of masks for fingertips. Each has a number; 0 is the loop's initial
  // one, if any.

  /// Continues with another puppet of the loop's initial model. It gets the number next_puppet(),
  /// and is kept for undo. Functions of the same name keep their values. In type 1, only the
  /// difference of the puppets changes the shape. A puppet without points changes the fingertips'
  /// masks and mirror: the stroke ends, and the fingertips re-grab the same shape. Errors:
  /// bad_input (its points are too close to each other, or it has none, and the loop began with a
  /// played puppet); failed (the loop holds still, or a change of log or model is pending: try
  /// again later). Then nothing changes. Allocates.
  Result<void> change_puppet(std::shared_ptr<const puppet::Rig> rig);
  /// Returns to an earlier puppet, by its number.
  Result<void> change_puppet(std::uint32_t number);
  std::uint32_t next_puppet() const noexcept;
  /// Returns the puppet of that number; null: the hands touch the model.
  const std::shared_ptr<const puppet::Rig>& puppet(std::uint32_t number) const noexcept;
  /// Returns the number of the last requested puppet.
  std::uint32_t newest_puppet() const noexcept;
  /// Returns the loop's initial puppet; null: the hands touched the model.
  const puppet::Rig* first_puppet() const noexcept;

  // A change of the model has two stages, so that the hands can shape while it is made, and no work
  // is lost. Make a PendingModel from newest_model(), call hold_still() and, when is_still(),
  // change_model(). No log may begin or end meanwhile.

  /// Stops the hands from shaping at the end of the next tick (Shaping::hold_still()). Error:
  /// failed (a change is pending, or the loop already holds still); then nothing changes.
  Result<void> hold_still();
  /// Returns whether the loop holds still and waits for a model.
  bool is_still();
  /// Finishes the model, made from newest_model(), for the loop, which must hold still. Calls
  /// `accepts` with the new version before the loop gets it. The loop takes settings that are
  /// requested meanwhile together with it. Later, versions that no undo or redo can reach are
  /// freed. After an error the loop continues with its present model. Errors: those of `accepts`
  /// and PendingModel::finish(); bad_input (a cut or join of a puppet's model, or no solution for a
  /// puppet's points on that version). Allocates.
  Result<void> change_model(PendingModel& finer,
                            const std::function<Result<void>(const ModelVersion&)>& accepts = {});
  /// Makes a loop that holds still continue with its present model.
  void keep_model();
  /// Returns the last version that was handed to the loop.
  const ModelVersion& newest_model() const noexcept;
  /// Returns the version of that number; null: none. change_model() may release it.
  std::shared_ptr<const ModelVersion> model(std::uint32_t number) const noexcept;
  /// Returns the layout of an existing version. It converts a frame's shape to points in the mesh's
  /// order.
  const deform::BlockLayout& layout(std::uint32_t version = 0) const noexcept {
    return model(version)->layout();
  }
  /// Allocates memory for more undos, up to the maximum. Call it regularly. Returns false if the
  /// maximum is reached, so that the oldest steps will be dropped.
  bool refill_undo();

  /// The loop takes changes from this, and reports completed ones. Loop's thread.
  JobOffer<PreparedChange*>& offers() noexcept;
  /// Returns the initial version, before the first tick. Loop's thread.
  ModelVersion& first_model() noexcept;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::flow
