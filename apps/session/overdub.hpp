#pragma once
// Overdubbing: a run replays a recording, the take, while live gloves play some joints over it. A
// recording of the run contains the take's input.

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

/// The values of the options --over, --layer, --punch and --loop.
struct OverdubArguments {
  std::string take;  ///< empty: only live gloves
  std::string layer; ///< empty: the hands that the take lacks, or all
  std::string punch; ///< IN:OUT; empty: from the beginning to the end
  std::string loop;  ///< A:B; empty: the take plays once
};
void add_overdub_options(const cli::Command& command, OverdubArguments& arguments);

/// The take that live gloves play over.
struct Overdub {
  /// Times since the take's first tick. An open `to` is HostClock::duration::max().
  struct Span {
    HostClock::duration from{};
    HostClock::duration to{};
  };

  std::string file;
  recording::TakeInput take;
  std::optional<Span> punch{};
  HostTime begin{}; ///< the deadline of the take's first tick; set by play_over()

  bool begins_on() const noexcept { return !punch || punch->from == HostClock::duration::zero(); }
};

/// Returns whether the take has that hand.
bool has_hand(const recording::Setup& take, Side side);

/// The angles that live gloves play, by flow::Placement::index_of(side). Nothing: whole hands.
using LivePart = std::optional<std::array<flow::AngleSet, 2>>;

/// Reads the take, and parses its options. Blocks. Errors: usage, naming the option; and those of
/// read_take_input().
Result<std::shared_ptr<Overdub>> read_overdub(const OverdubArguments& arguments);

/// Chooses the angles that live gloves play: those of --layer; without it, all angles of the gloves
/// in `options` or, if none is named, the hands that the take lacks, or else both. Errors: usage
/// (--layer; a glove that plays nothing; a part that no glove plays).
Result<LivePart> live_part(const OverdubArguments& arguments, const RunOptions& options);

/// Replaces the settings in the options by the take's. `model` is the recorded one. Errors: those
/// of recording::loop_options_of().
Result<void> take_over_settings(const deform::Mesh& model, RunOptions& options);

/// Inserts the take's inputs before those of live gloves, which become layers, and schedules its
/// script to begin shortly. `options` must have a take. Error: usage (too many layers).
Result<void> play_over(const RunOptions& options, std::vector<flow::HandInput>& inputs);

} // namespace nendo::session
