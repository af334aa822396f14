#pragma once
// A guided calibration as a state machine: samples and the wearer's actions go in, and what to show
// comes out. The terminal and the window draw it. Fits of the poses so far run on a thread of their
// own, so that no call but settle() takes long. One thread.

#include <cstdint>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/skeleton.hpp>

#include "calibrate/guide.hpp"
#include "gloves/monitor_screen.hpp"

namespace nendo::calibrate {

enum class GuideAction : std::uint8_t { begin, back, take_more, skip, leave_out, restart, finish };

struct GuideActionRow {
  GuideAction action;
  char key;
  std::string_view word;  ///< at the terminal
  std::string_view label; ///< on a button
  std::string_view help;
};
std::span<const GuideActionRow> guide_actions() noexcept;

enum class GuideEnd : std::uint8_t {
  complete, ///< every pose was taken or skipped, and a calibration fits them
  written,  ///< the wearer asked to finish with the poses taken so far, and a calibration fits them
};

/// What the wearer must know. The text does not say what to do; that depends on the keys or
/// buttons.
struct GuideNotice {
  enum class Kind : std::uint8_t {
    none,
    left_out,     ///< sensors are stuck; to start again uses them again
    will_restart, ///< asked for once more, a restart forgets every pose
    unfitted,     ///< no calibration fits the poses
  } kind = Kind::none;
  std::string text{};
};

class GuidedCalibration {
public:
  /// `info` and `guide` must outlive it.
  GuidedCalibration(const driver::GloveInfo& info, hand::FitOptions fit, CalibrationGuide& guide);

  /// Takes the next sample in time.
  void push(const GloveSample& sample);
  /// Takes the result of a fit that is ready, and begins the next one if the poses have changed. If
  /// no calibration fits when the guide ends, notice() says why, and the guide continues, with the
  /// last pose once more if all were taken.
  void update();
  /// Waits until the fit of the present poses is known. Blocks for up to a second.
  void settle();

  /// Does what the wearer asks for. `restart` needs to be asked for twice in a row.
  void act(GuideAction action);
  void dismiss_notice() { notice_ = {}; }
  /// Takes the pose of that number again; also after the end.
  void ask_for(std::size_t number);

  const driver::GloveInfo& info() const noexcept { return *info_; }
  const CalibrationGuide& guide() const noexcept { return *guide_; }
  bool has_begun() const noexcept { return begun_; } ///< false: the free motion continues
  /// Returns how the guide has ended; nothing while it continues, or while the last fit runs.
  std::optional<GuideEnd> end() const noexcept { return end_; }
  /// Returns whether the last fit is awaited. The guide may be done then.
  bool is_ending() const noexcept { return wanted_.has_value(); }
  const GloveSample* latest() const noexcept { return latest_ ? &*latest_ : nullptr; }
  const gloves::SeenCounts& seen() const noexcept { return seen_; } ///< includes latest()
  bool is_silent(HostTime now) const noexcept;                      ///< no sample for a second
  /// Returns sensors that the poses so far leave open; empty before the poses begin.
  SensorMask undetermined() const noexcept { return begun_ ? undetermined_ : SensorMask{}; }
  const GuideNotice& notice() const noexcept { return notice_; }
  /// Returns the pose that is asked for, of an average hand. The guide must not be done.
  const hand::HandPose& demonstration();

  /// Returns whether a fit of the poses so far, or a calibration to touch up, gives the angles.
  bool is_fitted() const noexcept { return fit_.has_value() || options_.start.has_value(); }
  /// Returns the best calibration so far: the fit of the poses, or else the one to touch up, or
  /// else what the ends of the free motion and the flat hand say, or else the default.
  hand::Calibration calibration() const;

private:
  void poses_changed() noexcept { result_.reset(), is_stale_ = true; }
  bool report_left_out();
  void leave_out_troubled();
  void restart(bool asked_before);
  void begin_fit();
  void conclude(GuideEnd end);
  SensorMask sensors() const noexcept;

  const driver::GloveInfo* info_;
  hand::FitOptions options_;
  CalibrationGuide* guide_;
  gloves::SeenCounts seen_;
  std::optional<GloveSample> latest_;
  bool begun_ = false;
  GuideNotice notice_;   ///< stays until the wearer does something
  SensorMask announced_; ///< the sensors left out that the wearer knows of
  struct Demonstration {
    hand::PoseId of;
    hand::HandPose pose;
  };
  std::optional<Demonstration> shown_;

  std::future<Result<hand::CalibrationFit>> running_;
  bool is_stale_ = true; ///< the poses have changed since the last fit began
  std::optional<Result<hand::CalibrationFit>> result_; ///< the present poses' fit
  std::optional<hand::CalibrationFit> fit_;            ///< the latest that succeeded
  SensorMask undetermined_;
  std::optional<GuideEnd> wanted_, end_;
};

} // namespace nendo::calibrate
