#pragma once
// What is asked of a run: passed on to its loop, or kept until it can be done.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/loop_commands.hpp"
#include "session/observer.hpp"
#include "session/run_models.hpp"
#include "session/run_recording.hpp"
#include "session/run_saving.hpp"

namespace nendo::session {

/// For the main thread.
class RunCommands {
public:
  using Report = std::function<void(const std::string& message)>;

  /// All of them must outlive this. `placed` has its loop before the first call but of ring().
  RunCommands(const RunOptions& options, const PlacedLoop& placed, const std::vector<Sink*>& sinks,
              RunRecorder& recorder, RunModels& models, RunSaving& saving, Report report)
      : options_(options), placed_(placed), sinks_(sinks), recorder_(recorder), models_(models),
        saving_(saving), report_(std::move(report)) {}

  /// The ring that the loop takes its commands from.
  flow::CommandRing& ring() noexcept { return for_loop_.ring(); }
  /// Follows the latest frame: cuts by a wire that has been drawn, and says that layers came in.
  void follow_frame(const flow::Frame& frame);
  /// Obeys these and what the take that is played over asks for, as far as that goes at once.
  void obey(const Asks& asks);
  /// Does what is due: passes on the newest settings when the loop has those before, changes
  /// puppets, begins or ends a recording, and continues with making a model.
  void follow(bool fresh);
  /// Returns whether something was asked for and is not done.
  bool is_due() const;
  /// Returns whether somebody has asked for the end.
  bool ends() const noexcept { return ends_; }

private:
  using Rig = std::shared_ptr<const puppet::Rig>;

  void dispatch(const flow::Command& command);
  void dispatch(const Rig& rig) { puppet_ = rig; } // only the newest counts
  void obey(flow::Request request) { for_loop_.push(request); }
  void obey(const flow::WristMove& move);
  void obey(const flow::ChangeSettings& change) { settings_ = change.settings; } // the newest
  void obey(const flow::SetRecording& recording) { record_ = recording.on; }
  void obey(const flow::SaveShape& save) { saving_.add(save); }
  void obey(const flow::SavePuppet& save) { saving_.add(save); }
  void obey(const flow::SaveRecording& save) { saving_.add(save); }
  void obey(const flow::EndRun&) noexcept { ends_ = true; }
  void obey(const flow::Mark&);
  void obey(const flow::Punch&);
  void obey(const flow::SetClutch& clutch) { play_otherwise(clutch); }
  void obey(const flow::SetRole& role) { play_otherwise(role); }
  void obey(const flow::SetSymmetry& symmetry);
  void obey(const flow::SetMask& mask) { mask_edits_.emplace_back(mask); }
  void obey(const flow::DrawWire& draw) { for_loop_.push(draw); }
  void obey(const flow::Subdivide& asked) { ask_model(asked); }
  void obey(const flow::Refine& asked) { ask_model(asked); }
  void obey(const flow::ChangeTopology& asked) { ask_model(asked); }
  void obey(const flow::JoinParts& asked) { ask_model(asked); }
  void obey(const flow::EditPart& asked) { ask_model(asked); }
  void obey(const flow::ChangePuppet& change);
  // Nobody asks for these, which only tell a log what a loop did, or are made of Punch.
  void obey(const flow::HoldStill&) noexcept {}
  void obey(const flow::ChangeModel&) noexcept {}
  void obey(const flow::SetLayer&) noexcept {}

  void ask_model(const flow::Command& command) { models_.ask(*flow::model_asked_by(command)); }
  void play_otherwise(const flow::Command& command);
  bool plays_puppet() const;
  bool may_change_puppet() const;
  void change_settings();
  void edit_masks();
  void change_puppet();
  void follow_taken_puppet();
  void tell(const std::optional<std::string>& message) const {
    if (message) report_(*message);
  }

  const RunOptions& options_;
  const PlacedLoop& placed_;
  const std::vector<Sink*>& sinks_;
  RunRecorder& recorder_;
  RunModels& models_;
  RunSaving& saving_;
  Report report_;
  LoopCommands for_loop_{256};
  std::array<std::optional<flow::WristMove>, 2> wrists_; ///< not passed on yet
  bool move_refused_ = false;                            ///< the latest, of a wrist; it was said
  bool ends_ = false;
  std::optional<flow::LoopSettings> settings_; ///< not passed on yet
  std::string no_effect_;                      ///< why one of them has none; it was said
  Rig puppet_;                                 ///< not passed on yet
  std::optional<std::uint32_t> taken_puppet_;  ///< likewise, by the take's number
  std::uint64_t take_refused_ = 0; ///< commands of the take that found no room; it was said
  std::map<std::uint32_t, std::uint32_t> taken_puppets_; ///< the loop's numbers of the take's
  std::vector<flow::Command> mask_edits_;                ///< likewise, and symmetry
  std::optional<bool> record_;                           ///< to a file, or not; not done yet
  std::uint32_t wires_ = 0;                              ///< that have been drawn to their end
  std::uint64_t marks_ = 0;
  std::optional<bool> is_in_; ///< the live layers play, in the latest frame
};

} // namespace nendo::session
