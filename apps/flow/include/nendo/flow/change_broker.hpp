#pragma once
// Changes of a loop's settings, puppet, model and log. The asking thread makes all that they need;
// the loop takes them ready at the beginning of its next tick.

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

/// What a loop or a timeline begins with: for its ChangeBroker, and for its ShapingCore.
struct CoreOptions {
  SculptorSetup setup; ///< without the additions of a puppet, masks or hands' bodies
  ShapingOptions shaping{};
  std::vector<Side> hands; ///< one or two, in the order of their control points
  std::size_t inputs = 1;  ///< hands and layers
  std::shared_ptr<HandBodies> bodies;
  double units_per_metre = 1.0;
  /// A puppet that hands play, or masks and a mirror for their fingertips; null: neither.
  std::shared_ptr<const puppet::Rig> rig{};
  puppet::RigState rig_state{}; ///< the state of the puppet's player at first
  /// Further puppets, for change_puppet() by their numbers, from 1 on.
  std::vector<std::shared_ptr<const puppet::Rig>> more_rigs{};
  std::size_t undo_max_bytes = 0; ///< UndoSpace::max_bytes, of all versions together
};

/// Asking thread, which may be the loop's, but for the last two functions. Changes that the loop
/// has not taken yet are taken together.
class NENDO_API ChangeBroker {
public:
  /// Copies the model. With `first`, the shape is at first that one, in the blocks of the model's
  /// layout. Allocates.
  ChangeBroker(const deform::Mesh& model, const CoreOptions& options,
               const deform::BlockShape* first = nullptr);
  ~ChangeBroker();

  /// Returns whether the loop has yet to take a change.
  bool is_changing();

  /// Makes all that these settings need: the stroke in hand then ends, and the fingertips grab the
  /// same shape again. What is shaped between changes that are less than a second apart is one
  /// step for undo. The last requested settings change nothing. Allocates. Error, bad_input:
  /// why they are not possible (compatible()); nothing changes then.
  Result<void> change_settings(const LoopSettings& settings);
  /// Returns the last requested settings, and their sculptor's options.
  const LoopSettings& settings() const noexcept { return setup().settings; }
  const SculptorOptions& sculptor_options() const noexcept { return setup().options; }
  const SculptorSetup& setup() const noexcept;
  /// Asks for what an undo or a redo waits for (Frame::awaited): settings, a puppet, or a version
  /// of the model that is kept. Allocates. Errors, and then nothing changes: bad_input (there are
  /// no such, or change_settings() does not take them); failed (the loop has yet to take another
  /// change of models: ask again later).
  Result<void> change_to(const Awaited& awaited);

  /// Logs the input to `log` from a tick on, or nowhere. That tick keeps what the hands have
  /// shaped, and they grab again; a log gets no undo that leads back before it. Ask take_state()
  /// when it has happened. Both logs must outlive that. `like` is a shape of the latest frames: the
  /// tick copies only the blocks that differ from it.
  void change_log(InputLog* log, const deform::BlockShape& like);
  /// Returns the state with which the log began, or ended, once for each change_log() that the loop
  /// has taken.
  std::optional<LoopState> take_state();

  // Other puppets, and other masks of fingertips. Each has a number; 0 is what the loop began with,
  // which may be none.

  /// Continues with another puppet of the model with which the loop began. It gets next_puppet() as
  /// its number, and is kept for undo. Functions of the same name keep their values. In type 1 the
  /// shape changes by what the puppets differ in, and by nothing else. Without points, it is the
  /// fingertips' masks and mirror that change: the stroke ends, and they grab the same shape again.
  /// Errors: bad_input (its points are too near to each other, or it has none, and the loop began
  /// with hands that play one); failed (the loop holds still, or is about to begin a log or another
  /// model: ask again later). Then nothing changes. Allocates.
  Result<void> change_puppet(std::shared_ptr<const puppet::Rig> rig);
  /// Does the same with one that the loop has had.
  Result<void> change_puppet(std::uint32_t number);
  std::uint32_t next_puppet() const noexcept;
  /// Returns that puppet; null if it is none, and the hands touch the model.
  const std::shared_ptr<const puppet::Rig>& puppet(std::uint32_t number) const noexcept;
  /// Returns the number of the last requested one.
  std::uint32_t newest_puppet() const noexcept;
  /// Returns the puppet with which the loop began; null if the hands touched the model.
  const puppet::Rig* first_puppet() const noexcept;

  // Another model, in two changes, so that the hands continue while it is made and nothing is lost
  // of their work. Make a PendingModel of newest_model(); ask the loop to hold still; when it
  // does, finish the model and hand it over. No log may begin or end meanwhile.

  /// Lets the hands stop shaping at the end of the next tick (Shaping::hold_still()). Error:
  /// failed, if the loop has yet to take a change or holds still already; then nothing changes.
  Result<void> hold_still();
  /// Returns whether the loop has done so, and waits for a model.
  bool is_still();
  /// Finishes the model, which must be made of newest_model(), for the loop, which must be still.
  /// `accepts` is called with the new version before the loop has it. Settings that are requested
  /// meanwhile come with it. Later, versions to which no undo or redo leads any more are freed.
  /// With an error the loop continues with the model that it has: the error of `accepts` or
  /// PendingModel::finish(), or bad_input if a puppet plays the model and it would be cut or
  /// joined, or a puppet's points cannot be solved for on that version. Allocates.
  Result<void> change_model(PendingModel& finer,
                            const std::function<Result<void>(const ModelVersion&)>& accepts = {});
  /// Lets a loop that holds still continue with the model that it has.
  void keep_model();
  /// Returns the version that the loop has or was asked last to continue with.
  const ModelVersion& newest_model() const noexcept;
  /// Returns that version; null if there is none. change_model() may release it.
  std::shared_ptr<const ModelVersion> model(std::uint32_t number) const noexcept;
  /// Returns the layout of a version that there is, which turns a frame's shape into points in the
  /// mesh's order.
  const deform::BlockLayout& layout(std::uint32_t version = 0) const noexcept {
    return model(version)->layout();
  }
  /// Allocates memory for more undos, up to the maximum. Call it now and then. Returns false if the
  /// maximum is reached, so that the oldest steps will be dropped.
  bool refill_undo();

  /// The loop takes changes out of this, and says when one is done. Loop's thread.
  JobOffer<PreparedChange*>& offers() noexcept;
  /// Returns the version with which a loop begins, before its first tick. Loop's thread.
  ModelVersion& first_model() noexcept;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

} // namespace nendo::flow
