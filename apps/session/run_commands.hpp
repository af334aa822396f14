#pragma once
// Executes the commands of a run: passes them to its loop, or queues them until they are possible.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/deform_loop.hpp>

#include "session/observer.hpp"
#include "session/run_models.hpp"
#include "session/run_options.hpp"
#include "session/run_recording.hpp"
#include "session/run_saving.hpp"

namespace nendo::session {

/// Passes commands to a running loop, and reports dropped ones. For one thread; the loop consumes
/// ring().
class LoopCommands {
public:
  explicit LoopCommands(std::size_t at_least) : ring_(at_least) {}

  flow::CommandRing& ring() noexcept { return ring_; }
  /// Returns the number of commands that the loop has not taken yet.
  std::size_t size() const noexcept { return ring_.size(); }
  /// Passes the command on. Returns false if the ring is full, as when the loop has stopped; the
  /// command is then dropped, and the next dropped() names it.
  bool push(const flow::Command& command);
  /// Passes the command on, or returns false if the ring is full.
  bool try_push(const flow::Command& command) noexcept { return ring_.try_push(command); }
  /// Returns a message with the commands dropped since the last call, or nothing. Names each
  /// command once until one is passed on again.
  std::optional<std::string> dropped();

private:
  flow::CommandRing ring_;
  std::vector<std::string_view> dropped_; ///< commands dropped since the last successful push()
  std::size_t reported_ = 0;              ///< the number of them that dropped() has named
};

class RunCommands {
public:
  using Reporter = std::function<void(const Report& message)>;

  /// All arguments must outlive this. `placed` must have its loop before the first call, except
  /// ring(). Main thread.
  RunCommands(const RunOptions& options, const PlacedLoop& placed, const std::vector<Sink*>& sinks,
              RunRecorder& recorder, RunModels& models, RunSaving& saving, Reporter report)
      : options_(options), placed_(placed), sinks_(sinks), recorder_(recorder), models_(models),
        saving_(saving), report_(std::move(report)) {}

  /// The loop's command ring.
  flow::CommandRing& ring() noexcept { return for_loop_.ring(); }
  /// Handles the latest frame: cuts by a completed wire, and reports punch in and out.
  void follow_frame(const flow::Frame& frame);
  /// Executes or queues these commands, and those of the take.
  void execute(const Asks& asks);
  /// Continues pending commands: passes on the newest settings when the loop has the previous ones,
  /// changes puppets, begins or ends a recording, and continues making a model.
  void follow(bool fresh);
  /// Returns whether a command is pending.
  bool is_due() const;
  /// Returns whether a command has ended the run.
  bool ends() const noexcept { return ends_; }

private:
  using Rig = std::shared_ptr<const puppet::Rig>;

  void dispatch(const flow::Command& command);
  void dispatch(const Rig& rig) { puppet_ = rig; } // only the newest counts
  void dispatch(const SaveShapeAs& save) { saving_.add(save.file); }
  void execute(flow::Request request) { for_loop_.push(request); }
  void execute(const flow::Recentre& recentre) { for_loop_.push(recentre); }
  void execute(const flow::WristMove& move);
  void execute(const flow::ChangeSettings& change) { settings_ = change.settings; } // newest only
  void execute(const flow::SetRecording& recording) { record_ = recording.on; }
  void execute(const flow::SaveShape& save) { saving_.add(save); }
  void execute(const flow::SavePuppet& save) { saving_.add(save); }
  void execute(const flow::SaveRecording& save) { saving_.add(save); }
  void execute(const flow::EndRun&) noexcept { ends_ = true; }
  void execute(const flow::Mark&);
  void execute(const flow::Punch&);
  void execute(const flow::SetClutch& clutch) { play_otherwise(clutch); }
  void execute(const flow::SetRole& role) { play_otherwise(role); }
  void execute(const flow::SetSymmetry& symmetry);
  void execute(const flow::SetMask& mask) { mask_edits_.emplace_back(mask); }
  void execute(const flow::DrawWire& draw) { for_loop_.push(draw); }
  void execute(const flow::Subdivide& asked) { ask_model(asked); }
  void execute(const flow::Refine& asked) { ask_model(asked); }
  void execute(const flow::ChangeTopology& asked) { ask_model(asked); }
  void execute(const flow::JoinParts& asked) { ask_model(asked); }
  void execute(const flow::EditPart& asked) { ask_model(asked); }
  void execute(const flow::ChangePuppet& change);
  // Not from users: a loop logs them, or Punch makes them.
  void execute(const flow::HoldStill&) noexcept {}
  void execute(const flow::ChangeModel&) noexcept {}
  void execute(const flow::SetLayer&) noexcept {}

  void ask_model(const flow::Command& command) { models_.ask(*flow::model_asked_by(command)); }
  void play_otherwise(const flow::Command& command);
  bool plays_puppet() const;
  bool may_change_puppet() const;
  void change_settings();
  void edit_masks();
  void change_puppet();
  void follow_taken_puppet();
  void report(const std::optional<Report>& message) const {
    if (message) report_(*message);
  }

  const RunOptions& options_;
  const PlacedLoop& placed_;
  const std::vector<Sink*>& sinks_;
  RunRecorder& recorder_;
  RunModels& models_;
  RunSaving& saving_;
  Reporter report_;
  LoopCommands for_loop_{256};
  std::array<std::optional<flow::WristMove>, 2> wrists_; ///< not passed on yet
  bool move_refused_ = false;                            ///< a refused wrist move was reported
  bool ends_ = false;
  std::optional<flow::LoopSettings> settings_; ///< not passed on yet
  std::string no_effect_;                      ///< the last reported setting without effect
  Rig puppet_;                                 ///< not passed on yet
  std::optional<std::uint32_t> taken_puppet_;  ///< the take's number, not passed on yet
  std::uint64_t take_refused_ = 0; ///< the reported number of the take's dropped commands
  std::map<std::uint32_t, std::uint32_t> taken_puppets_; ///< maps the take's numbers to the loop's
  std::vector<flow::Command> mask_edits_; ///< edits of masks and symmetry, not passed on yet
  std::optional<bool> record_;            ///< the requested recording, not passed on yet
  std::uint32_t wires_ = 0;               ///< number of completed wires
  std::uint64_t marks_ = 0;
  std::optional<bool> is_in_; ///< the live layers play in the latest frame
};

} // namespace nendo::session
