#pragma once
// A run from gloves to a shape: opens what was asked for, places the hands, and runs the loop on a
// thread of its own.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>

#include "glove_calibration.hpp"
#include "hand_length.hpp"
#include "open_hand.hpp"
#include "run_recording.hpp"

namespace nendo::app {

struct RunOptions {
  std::string left;        ///< GLOVE; empty: not asked for
  std::string right;       ///< GLOVE; empty: not asked for
  std::string mesh;        ///< empty: the shipped model
  std::string out;         ///< empty: a name made of date and time
  std::string picture;     ///< empty: none
  double duration_s = 0.0; ///< 0: until a stop signal
  std::string radius;      ///< as deform::parse_supports_by_point; empty: of the model's size
  bool json = false;
  CalibrationOptions calibration;
  HandLength length;
  hand::FilterOptions filter; ///< of both hands
  flow::LoopOptions loop;
  RecordingOptions recording;
  flow::RealtimeOptions realtime;  ///< of the loop's thread
  std::vector<flow::Grant> grants; ///< what was asked for before, of the process and the readers
};

/// Opens and starts the gloves and waits for the first sample of each. With none named it uses what
/// is identified, and simulated hands, saying so, if there is nothing. Errors as open_glove();
/// no_device if no sample comes; as known_hands();
/// as open_touching_glove(), whose hands touch `model`.
/// The readers get the priority that goes with the loop's; what the system says to that is added to
/// options.grants. With OverrunPolicy::sample, `bell` is what wakes the loop; it must outlive both.
Result<std::vector<OpenHand>> open_hands(RunOptions& options, const deform::Mesh& model,
                                         Bell& bell);

/// Memory for some dozens of whole shapes, of which strokes mostly change parts; 64 MiB at most.
std::size_t undo_bytes_for(const deform::Mesh& model) noexcept;

/// Whether a --radius is one, for hands at all. Error: usage.
Result<void> check_radius(const std::string& text);

/// What the summary is made of.
struct RunOutcome {
  flow::LoopStats stats;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  double radius = 0.0; ///< the largest
  std::string result;
  std::vector<flow::Grant> grants;
  RecordingOutcome recording;
};

/// The loop over these hands, which hold the model between them.
struct PlacedLoop {
  std::unique_ptr<flow::DeformLoop> loop;
  double radius = 0.0; ///< the largest
  PlacedSetup setup;   ///< what it was made of; its supports are in model units
};

/// As options.loop says, with the supports that options.radius says. Without a placement the hands
/// are put to the model. Errors: usage (radius), failed (the hands cannot take hold of the model).
Result<PlacedLoop> place_loop(const RunOptions& options, const std::vector<OpenHand>& hands,
                              const deform::Mesh& model,
                              const std::optional<flow::Placement>& placement = {});

/// How many deadlines of the grid a run lasts; no end where the clock alone says when it is over.
std::uint64_t ticks_for(const RunOptions& options) noexcept;
/// Whether a run that began at `start` has lasted its duration, by the clock.
bool is_over(const RunOptions& options, HostTime start) noexcept;

/// Called about four times a second with the latest frame.
using Progress = std::function<void(const flow::Frame& frame, double elapsed_s)>;

/// Who looks on from the main thread while a loop runs, and may have it made anew.
class Onlooker {
public:
  enum class Verdict { go_on, end, renew };

  virtual ~Onlooker() = default;
  /// Before each loop's first tick. `model` is what it shapes; all live until the next call.
  virtual void begin(const PlacedLoop& placed, const deform::Mesh& model,
                     const std::vector<OpenHand>& hands) = 0;
  /// Called over and over, and by its return sets the pace: within 30 ms. fresh: frames().front()
  /// is another one than at the call before.
  virtual Verdict look(flow::DeformLoop& loop, bool fresh) = 0;
  /// After `renew`, the loop has ended and left `model`: what is to be different.
  virtual void change(RunOptions& options, deform::Mesh& model) = 0;
};

/// Runs until the duration is over, a stop signal comes, or a key (run_keys.hpp) or the onlooker,
/// if any, says so, then writes the shape; says on standard error which rights were refused. A loop
/// that is made anew goes on from the shape and the poses as they are, with the hands where they
/// were; the outcome is then the last one's, the recording the first one's. Blocks.
Result<RunOutcome> run_session(RunOptions options, std::vector<OpenHand>& hands, deform::Mesh model,
                               const Progress& progress, Onlooker* onlooker = nullptr);

} // namespace nendo::app
