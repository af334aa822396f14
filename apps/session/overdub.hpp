#pragma once
// A take in layers: a recording is played once more, and live gloves play some joints over it. The
// run is recorded as any other, with the take's input in it.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/flow/hand_input.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "cli/command.hpp"

namespace nendo::session {

struct RunOptions;

/// The options --over, --layer, --punch and --loop, as they are given.
struct OverdubArguments {
  std::string take;  ///< empty: live gloves alone
  std::string layer; ///< empty: what the take lacks, or all
  std::string punch; ///< IN:OUT; empty: from the beginning to the end
  std::string loop;  ///< A:B; empty: the take is played once
};
void add_overdub_options(const cli::Command& command, OverdubArguments& arguments);

/// What is played over.
struct Overdub {
  /// Since the take's first tick. `to` is HostClock::duration::max() where it is left open.
  struct Span {
    HostClock::duration from{};
    HostClock::duration to{};
  };

  std::string file;
  recording::TakeInput take;
  std::optional<Span> punch{};
  HostTime begin{}; ///< when the take's first tick is to be due; set by play_over()

  bool begins_on() const noexcept { return !punch || punch->from == HostClock::duration::zero(); }
};

/// Returns whether the take has that hand.
bool has_hand(const recording::Setup& take, Side side);

/// What live gloves play, of both hands by flow::Placement::index_of(side). Nothing: whole hands.
using LivePart = std::optional<std::array<flow::AngleSet, 2>>;

/// Reads the take and what is to be done with it. Blocks. Errors: usage, naming the option; and
/// those of read_take_input().
Result<std::shared_ptr<Overdub>> read_overdub(const OverdubArguments& arguments);

/// Chooses what live gloves play: what --layer says; without it, all that the gloves in `options`
/// give or, if none is named, the hands that the take lacks or, if it lacks none, both. Errors:
/// usage (--layer; a glove that plays nothing; a part that no glove plays).
Result<LivePart> live_part(const OverdubArguments& arguments, const RunOptions& options);

/// Puts the settings of the take into the options, in place of those of the command line. `model`
/// is the recorded one. Error: bad_input, as from recording::loop_options_of().
Result<void> take_over_settings(const deform::Mesh& model, RunOptions& options);

/// Puts the take's inputs before those of live gloves, which become layers, and makes its script
/// ready to begin a moment from now. `options` have a take. Error: usage (too many layers).
Result<void> play_over(const RunOptions& options, std::vector<flow::HandInput>& inputs);

} // namespace nendo::session
