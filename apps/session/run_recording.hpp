#pragma once
// Records a run: the options, the input log, and the recorder beside the loop.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/recording/recorder.hpp>

#include "cli/command.hpp"
#include "gloves/open_hand.hpp"
#include "session/report.hpp"

namespace nendo::session {

struct PlacedLoop;
struct RunOptions;

struct RecordingOptions {
  bool on = false;       ///< records to a file
  std::string file;      ///< the name of the first file; later names are derived from it
  std::string keep_last; ///< a duration for cli::parse_duration(); empty: nothing is kept in memory
  double keep_last_s = 0.0;
  std::string kept_stem; ///< the prefix of the names of kept files

  bool wanted() const noexcept { return on || keep_last_s > 0.0; }
  /// Checks the options and reads `keep_last`. Files without a name get one beside `out`. Errors:
  /// usage; failed (the file exists).
  Result<void> check(const std::string& out, flow::SwitchAction action);
};

/// Adds --record and --keep-last.
void add_recording_options(const cli::Command& command, RecordingOptions& options);

/// The result of one recording.
struct RecordingOutcome {
  std::string file;                            ///< empty: in memory only
  std::optional<recording::Recorded> recorded; ///< nothing: incomplete
};

/// Returns a setup with the program, the time, the wearer, the gloves in the order of the hands,
/// and the trackers.
recording::Setup begin_setup(const std::vector<gloves::OpenHand>& hands, const std::string& wearer);

/// Returns the record counts of each glove since its start, in the order of the hands. Thread-safe.
/// Allocates; otherwise wait-free.
std::vector<driver::RecordCounts> counts_of(const std::vector<gloves::OpenHand>& hands);

/// Records a run: from its beginning, or from any tick to any later one. Each recording has its own
/// log and recorder; the names of later ones are numbered.
class RunRecorder {
public:
  /// All arguments must outlive this.
  RunRecorder(const RunOptions& options, const PlacedLoop& placed,
              const std::vector<gloves::OpenHand>& hands, const deform::Mesh& model)
      : options_(options), placed_(placed), hands_(hands), model_(model) {}

  /// Makes the log of the initial recording, for place_loop(). Returns null if the run does not
  /// begin with a recording.
  flow::InputLog* first_log();
  /// Begins the initial recording, before the loop runs. Error: failed (the file cannot be
  /// created).
  Result<void> begin();
  /// Requests a new recording, to a file or in memory. `frame` is the latest one. Do not call it
  /// while is_changing().
  void set_file(bool on, const flow::Frame& frame);
  /// Completes a change; call it repeatedly. Returns a message for the user if a recording could
  /// not begin; the run continues.
  std::optional<Report> follow();
  /// Ends the recording. To be called after the loop's last tick, with its final shape.
  void end(const deform::Points& shape);

  bool is_changing() const noexcept { return is_changing_; }
  /// Returns whether it records to a file.
  bool is_to_file() const noexcept { return to_file_; }
  /// Returns whether it records, to a file or in memory.
  bool is_recording() const noexcept { return recorder_ != nullptr; }
  /// Returns whether --keep-last was given.
  bool keeps_last_minute() const noexcept;
  /// Records a puppet before the loop gets it.
  void add_puppet(std::uint32_t number, const puppet::Rig& rig);
  /// Requests writing the recording in memory to a file. Does nothing without keeps_last_minute().
  /// Wait-free.
  void save_last_minute() noexcept;
  /// Returns the file of the last complete recording; empty: none.
  const std::string& last_file() const noexcept { return last_file_; }
  /// Returns one outcome for each recording.
  const std::vector<RecordingOutcome>& outcomes() const noexcept { return outcomes_; }

private:
  using Counts = std::vector<driver::RecordCounts>;
  recording::Setup setup_now() const; ///< the loop's initial setup
  Counts counts() const;              ///< the counts of all inputs of the loop
  Result<void> begin(const recording::Setup& setup, const Counts& before);
  void end_with(const recording::ShapeSum& shape);
  std::string next_name();

  const RunOptions& options_;
  const PlacedLoop& placed_;
  const std::vector<gloves::OpenHand>& hands_;
  const deform::Mesh& model_; ///< the loaded model
  std::unique_ptr<flow::InputLog> log_;
  std::unique_ptr<recording::Recorder> recorder_; ///< the recorder of log_; null: none
  bool to_file_ = false;
  std::unique_ptr<flow::InputLog> next_log_; ///< the log to change to; null: none
  Counts counts_;                            ///< the counts at the request
  bool is_changing_ = false;
  bool next_to_file_ = false;
  int number_ = 1; ///< the number in the latest recording's name
  std::string last_file_;
  std::vector<RecordingOutcome> outcomes_;
};

} // namespace nendo::session
