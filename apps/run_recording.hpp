#pragma once
// A run that is recorded: its options, the tape and the recorder beside the loop.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/recording/recorder.hpp>

#include "command.hpp"
#include "open_hand.hpp"

namespace nendo::app {

struct PlacedSetup;
struct RunOptions;

struct RecordingOptions {
  std::string file;      ///< empty: none
  std::string keep_last; ///< as parse_duration(); empty: nothing is kept in memory
  double keep_last_s = 0.0;
  std::string kept_stem; ///< what kept files are called by

  bool wanted() const noexcept { return !file.empty() || keep_last_s > 0.0; }
  /// Reads `keep_last`; kept files stand beside `out`. Errors: usage; failed (the file is there).
  Result<void> check(const std::string& out, flow::SwitchAction action);
};

/// --record and --keep-last.
void add_recording_options(Command& command, RecordingOptions& options);

struct RecordingOutcome {
  std::optional<recording::Recorded> recorded; ///< nothing: not asked for, or not all was recorded
  bool has_failed = false;
};

/// Who, when and with what: the beginning of every recording's setup. By the hands' order.
recording::Setup begin_setup(const std::vector<OpenHand>& hands, const std::string& wearer);

class RunRecorder {
public:
  explicit RunRecorder(const RecordingOptions& options);
  /// What the loop is to record on; null: nothing is wanted of it.
  flow::Tape* tape() noexcept { return tape_ ? &*tape_ : nullptr; }
  /// Before the loop runs. Error: failed, if the file cannot be made.
  Result<void> begin(const RunOptions& options, const PlacedSetup& placed,
                     const std::vector<OpenHand>& hands, const deform::Mesh& model);
  /// Whether keep() does anything: with --keep-last, from begin() to end().
  bool keeps() const noexcept { return keeps_; }
  /// What was done last becomes a file. Wait-free.
  void keep() noexcept;
  /// After the loop's last tick.
  RecordingOutcome end(const deform::Mesh& shape);

private:
  std::optional<flow::Tape> tape_;
  std::unique_ptr<recording::Recorder> recorder_;
  bool keeps_ = false;
};

} // namespace nendo::app
