#pragma once
// A run from open gloves to a shape: runs the loop on a thread of its own, and follows it from the
// main thread.

#include <functional>
#include <string>
#include <vector>

#include "session/outlet.hpp"
#include "session/place_loop.hpp"
#include "session/run_publishing.hpp"

namespace nendo::session {

/// What the summary is made of.
struct RunOutcome {
  flow::LoopStats stats;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  double radius = 0.0; ///< the largest
  std::string result;
  std::vector<flow::Grant> grants;
  std::vector<RecordingOutcome> recordings; ///< one a loop
  std::vector<PublishedTo> published{};     ///< whoever owns the outlets knows
};

/// How many deadlines of the grid a run lasts; no end where the clock alone says when it is over.
std::uint64_t ticks_for(const RunOptions& options) noexcept;
/// Whether a run that began at `start` has lasted its duration, by the clock.
bool is_over(const RunOptions& options, HostTime start) noexcept;

/// Called about four times a second with the latest frame.
using Progress = std::function<void(const flow::Frame& frame, double elapsed_s)>;

/// Who looks on from the main thread while a loop runs, and may have it made anew.
class Onlooker : public Follower {
public:
  enum class Verdict { go_on, end };

  /// Before each loop's first tick. `model` is what it shapes; all live until the next call but
  /// `options`, which are those in force.
  virtual void begin(const PlacedLoop& placed, const deform::Mesh& model,
                     const std::vector<gloves::OpenHand>& hands, const RunOptions& options) = 0;
  /// Called over and over, and by its return sets the pace: within 30 ms. fresh: frames().front()
  /// is another one than at the call before.
  virtual Verdict look(flow::DeformLoop& loop, bool fresh) = 0;
  /// After the last loop, whatever ended it; the shape has been written. An error is the run's.
  virtual Result<void> end() { return {}; }
};

/// Who follows a run. All must outlive it.
struct Followers {
  Progress progress; ///< always there
  Onlooker* onlooker = nullptr;
  std::vector<Outlet*> outlets{};
};

/// Runs until the duration is over, a stop signal comes, or a key (run_keys.hpp) or the onlooker,
/// if any, says so, then writes the shape; says on standard error which rights were refused. A loop
/// that is made anew, because a follower wants a change, goes on from the shape and the poses as
/// they are, with the hands where they were and what --adapt has learned of them, and is recorded
/// to a file of its own if that is asked for; a few times a second at most, whoever asks how often.
/// A change with which no loop can begin is told of on standard error, and not made. The outcome is
/// the last loop's, with every recording. Blocks.
Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const Followers& followers);

} // namespace nendo::session
