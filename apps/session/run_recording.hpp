#pragma once
// Records a run: the options, the input log, and the recorder beside the loop.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/record_counts.hpp>
#include <nendo/recording/recorder.hpp>

#include "cli/command.hpp"
#include "gloves/open_hand.hpp"

namespace nendo::session {

struct PlacedSetup;
struct RunOptions;

struct RecordingOptions {
  bool on = false;       ///< a file is recorded
  std::string file;      ///< the name of the first file, of which later names are made
  std::string keep_last; ///< as for cli::parse_duration(); empty: nothing is kept in memory
  double keep_last_s = 0.0;
  std::string kept_stem; ///< the beginning of the names of kept files

  bool wanted() const noexcept { return on || keep_last_s > 0.0; }
  /// Checks the options and reads `keep_last`. Files without a name get one beside `out`. Errors:
  /// usage; failed (the file exists).
  Result<void> check(const std::string& out, flow::SwitchAction action);
};

/// Adds --record and --keep-last.
void add_recording_options(cli::Command& command, RecordingOptions& options);

/// The result of one loop's recording.
struct RecordingOutcome {
  std::string file;                            ///< empty: it was only kept in memory
  std::optional<recording::Recorded> recorded; ///< nothing: it is not complete
};

/// Begins a recording's setup: the program, the time, the wearer, and the gloves in the order of
/// the hands.
recording::Setup begin_setup(const std::vector<gloves::OpenHand>& hands, const std::string& wearer);

/// Returns what became of the records of each glove since it was started, in the order of the
/// hands. Any thread; wait-free but for its memory.
std::vector<driver::RecordCounts> counts_of(const std::vector<gloves::OpenHand>& hands);

/// Records the loops of a run. Each loop gets a file of its own; from the second on their names are
/// numbered. If a loop begins with another model than the one that was loaded, that model is
/// written beside its recording.
class RunRecorder {
public:
  /// `loaded` is the model as it is in the run's file.
  explicit RunRecorder(const deform::Mesh& loaded) : loaded_(recording::sum_of(loaded.vertices)) {}

  /// Makes the log that the next loop writes to. Returns null if the loop is not to be recorded.
  flow::InputLog* input_log_for(const RecordingOptions& options);
  /// Begins to record. Call it before each loop runs; `hands` must outlive its recording. Error:
  /// failed, if the files cannot be made; nothing is recorded then.
  Result<void> begin(const RunOptions& options, const PlacedSetup& placed,
                     const std::vector<gloves::OpenHand>& hands, const deform::Mesh& model);
  /// Returns true with --keep-last, from begin() to end().
  bool keeps_last_minute() const noexcept { return keeps_last_minute_; }
  /// Asks for the recording in memory to be written to a file. Does nothing unless
  /// keeps_last_minute(). Wait-free.
  void save_last_minute() noexcept;
  /// Ends the recording. Call it after the loop's last tick.
  void end(const deform::Mesh& shape);
  /// Returns one outcome for each loop that was to be recorded.
  const std::vector<RecordingOutcome>& outcomes() const noexcept { return outcomes_; }

private:
  std::string next_name(const RecordingOptions& options, bool with_model);

  std::unique_ptr<flow::InputLog> input_log_;
  std::unique_ptr<recording::Recorder> recorder_;
  recording::ShapeSum loaded_;
  int number_ = 1; ///< of the latest recording's name
  std::vector<RecordingOutcome> outcomes_;
  bool keeps_last_minute_ = false;
  bool first_loop_ = true;
};

} // namespace nendo::session
