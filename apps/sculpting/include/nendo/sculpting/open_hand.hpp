#pragma once
// An open glove with the ring for its samples and the wearer's calibration.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/hand/wrist_tracking.hpp>
#include <nendo/sculpting/find_wearer.hpp>

namespace nendo::sculpting {

/// A tracker's station that moves the wrist of a hand.
struct OpenWrist {
  std::unique_ptr<PoseRing> ring; ///< outlives the tracker, whose thread writes the poses
  driver::TrackerStation station;
  hand::TrackingOptions tracking{};
};

struct OpenHand {
  Side side = Side::right;          ///< the hand that it drives
  std::unique_ptr<SampleRing> ring; ///< outlives the glove, whose thread writes the samples
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;         ///< the first sample; set by wait_for_samples()
  hand::Wearer wearer;       ///< set by find_wearers()
  bool uncalibrated = false; ///< is_uncalibrated() of `wearer` and `first`
  /// The pose of the forearm's end, if known from another source than the glove.
  std::optional<Eigen::Isometry3d> T_stage_wrist{};
  std::shared_ptr<const flow::WristPath> wrist_path{}; ///< the path of a moving wrist
  std::optional<OpenWrist> wrist{};                    ///< nothing: no tracker moves it
};

/// Returns the input of a loop, without a filter and a wrist. `hand` must outlive the loop.
NENDO_API flow::HandInput input_of(const OpenHand& hand);
/// Makes a hand from an open glove. The default `side` is the glove's own; a different side is
/// noted. Each sample notifies `event_count`, which may be null and must outlive the hand.
NENDO_API OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                           EventCount* event_count, const Note& note);

using OpenNamed = std::function<Result<OpenHand>(const std::string& glove, Side side)>;

/// Opens this machine's gloves by `open`, one for each of these hands. A glove without access
/// permission is an error. If one does not answer, the other hand continues alone, with a note.
/// Without gloves, the hands are simulated as `simulated`, with a note. Blocks for some seconds.
/// Errors: those of `open`.
NENDO_API Result<std::vector<OpenHand>> open_found(std::span<const Side> sides,
                                                   const std::string& simulated,
                                                   const OpenNamed& open, const Note& note);

/// The trackers of a run's wrists.
struct WristOptions {
  std::array<std::string, 2> trackers; ///< TRACKER by the side of the hand; empty: none
  double movement_scale = 1.0;         ///< hand::TrackingOptions::movement_scale
  EventCount* event_count = nullptr;   ///< each pose notifies it; null: nothing
};

/// Opens the trackers of `options`, with the drivers of the library and `more`, for those of
/// `hands` that they move. A device gets its stored mount (hand::find_mount()), and a note says
/// which, or that there is none. Blocks. Errors: those of driver::open_trackers() and find_mount();
/// usage (no such hand, or both hands at one station).
NENDO_API Result<void> open_wrists(std::span<OpenHand> hands, const WristOptions& options,
                                   const Note& note,
                                   std::span<const driver::TrackerDriver> more = {});

/// Returns the tracking that suits the tracker, without a calibration of its mount.
NENDO_API hand::TrackingOptions usual_tracking(const driver::TrackerInfo& info) noexcept;

/// Starts the gloves and trackers. Blocks. Errors: those of Glove::start() and Tracker::start().
NENDO_API Result<void> start(std::span<OpenHand> hands);
/// Stops them. Blocks as Glove::stop() does.
NENDO_API void stop(std::span<OpenHand> hands) noexcept;

/// Restarts simulated gloves and trackers, and recordings, whose time begins at start(), so that it
/// does not pass while a run is prepared. Drops their earlier samples. No other thread may read
/// their rings meanwhile. Blocks as Glove::stop() does. Errors: those of Glove::start().
NENDO_API Result<void> begin_again(std::span<OpenHand> hands);

/// Returns whether all gloves have ended (Glove::has_ended()), so that no more samples will come.
/// All their samples are then in the rings, or were already taken. Thread-safe.
NENDO_API bool have_ended(std::span<const OpenHand> hands) noexcept;

/// Takes the first sample of each started glove from its ring. Blocks for up to 2 s, longer if the
/// glove's rate is low or unknown, or until `is_stopped`, if given, returns true. Errors: no_device
/// (no sample), failed (stopped).
NENDO_API Result<void> wait_for_samples(std::span<OpenHand> hands,
                                        const std::function<bool()>& is_stopped = {});

/// Calls find_wearer() for each hand, for the side of its first sample. Blocks. Errors: those of
/// find_wearer().
NENDO_API Result<void> find_wearers(std::span<OpenHand> hands, const CalibrationOptions& options,
                                    const Note& note);

} // namespace nendo::sculpting
