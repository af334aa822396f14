#pragma once
// A guided calibration with controls and hands, for the window and the page: who wears the glove,
// the poses as a hand to follow, and then how sure the result is, with a hand to try it. Main
// thread. Nothing blocks for longer than a picture: fits run beside.

#include <array>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/driver/glove.hpp>

#include "calibrate/findings.hpp"
#include "calibrate/guided_calibration.hpp"
#include "calibrate/pose_advice.hpp"
#include "calibrate/wearer_file.hpp"
#include "forms/form.hpp"
#include "studio/calibration_scene.hpp"

namespace nendo::studio {

using forms::Form;

struct CalibrationOutcome {
  /// What was written; nothing: the wearer left, or discarded it.
  std::optional<calibrate::FinishedCalibration> finished{};
  std::filesystem::path written{}; ///< where; empty: nowhere
  std::filesystem::path earlier{}; ///< where the previous version is; empty: there was none
  std::size_t kept = 0;            ///< poses kept for the next time
  bool adapt = false;              ///< the run shall learn on, as with --adapt
};

/// Returns the name of a certainty.
std::string_view in_words(calibrate::Certainty certainty);

/// The words above the hands.
struct CourseWords {
  std::string instruction, state;
  bool warns = false;
};

/// What is shown beside the controls.
struct CoursePicture {
  CourseWords words;
  std::vector<ShownHand> hands; ///< translucent ones last
  Ways ways;                    ///< arrows of the marked fingers
  std::vector<JointMark> joints;
  std::optional<double> ring; ///< the share of the ring about the wrist, 0 to 1; nothing: no ring
  bool warns = false;         ///< a finger is wrong, and so the ring
  render::View view;          ///< the direction from which the pose is read best
  double width_m = 0.0;
  /// From the middle to the live hand; the other hand is opposite. Zero: there is one hand.
  Eigen::Vector3d aside_m = Eigen::Vector3d::Zero();
};

class CalibrationCourse {
public:
  /// `request` is what the wearer finds filled in. With `fresh` it does not offer to continue an
  /// earlier session. `glove` must not have been started, and must outlive this.
  CalibrationCourse(driver::Glove& glove, calibrate::CalibrationRequest request,
                    bool fresh = false);
  ~CalibrationCourse(); ///< stops the glove; may wait for a fit
  CalibrationCourse(const CalibrationCourse&) = delete;
  CalibrationCourse& operator=(const CalibrationCourse&) = delete;

  /// Starts the glove. Errors: those of driver::Glove::start().
  Result<void> start();
  /// Takes samples and results, for the next picture.
  void update();
  const CoursePicture& picture() const noexcept { return picture_; }
  std::string title() const;
  /// Describes the controls, and does what the user asks for.
  void describe(Form& form);
  /// Does what this key does at the terminal.
  void press(char key);
  /// Ends as the button Leave does: without a calibration, but the poses are kept for the next
  /// time.
  void leave();
  /// Returns the outcome once it has ended. Error: failed (the poses could not be kept).
  std::optional<Result<CalibrationOutcome>> take_outcome() {
    return std::exchange(outcome_, std::nullopt);
  }

  /// Returns whether there are poses that nothing has kept yet, so that they are lost if this is
  /// destroyed.
  bool has_unkept_poses() const;
  Side side() const noexcept { return side_; }
  const std::optional<calibrate::FinishedCalibration>& finished() const noexcept {
    return finished_;
  }

private:
  static constexpr double aside_m = 0.11;  ///< distance of the two hands from the middle
  static constexpr double touch_m = 0.004; ///< pads that are nearer touch
  enum class Stage : std::uint8_t { before, guiding, fitting, after };

  // calibration_course.cpp
  void take_samples();
  void advance();
  void follow_name();
  void begin_guide();
  void begin_last_fit();
  void take_again();
  void keep_result();
  void discard();
  void pose_hands();
  void pose_free_motion();
  void pose_asked();
  void pose_result();
  void add_live(const hand::HandPose& pose, const Fingers& marked = {}, bool is_wrong = false);
  hand::JointAngles live_angles(const hand::Calibration& calibration) const;
  double shown_ranges() const;
  CourseWords words() const;
  CourseWords guide_words() const;
  std::string trouble() const;
  // calibration_form.cpp
  void describe_before(Form& form);
  void describe_guide(Form& form);
  void describe_actions(Form& form);
  void describe_takes(Form& form);
  void describe_after(Form& form);

  driver::Glove& glove_;
  SampleRing ring_{1024};
  std::optional<GloveSample> latest_;
  Side side_;
  calibrate::CalibrationRequest request_;
  bool fresh_;
  bool adapt_ = false;
  Stage stage_ = Stage::before;
  std::string problem_; ///< what failed; empty: nothing

  // Before:
  float length_mm_;
  std::vector<std::string> recent_names_;
  std::string touch_up_refusal_;              ///< why there is nothing to touch up; empty: there is
  bool has_kept_ = false;                     ///< an earlier session kept poses
  std::vector<hand::PoseReading> kept_poses_; ///< those that the guide began with
  bool continues_ = true;

  std::optional<calibrate::WearerFile> file_;
  std::optional<calibrate::CalibrationGuide> guide_;
  std::optional<calibrate::GuidedCalibration> guided_;
  std::vector<calibrate::PoseAdvice> advice_;
  HostTime guiding_since_{};

  std::future<Result<calibrate::FinishedCalibration>> fitting_;
  std::optional<calibrate::FinishedCalibration> finished_;
  std::vector<calibrate::Finding> findings_;
  std::optional<hand::HandSkeleton> skeleton_;       ///< the wearer's
  std::array<std::optional<double>, 4> nearest_m_{}; ///< from the thumb's pad to each finger's
  std::optional<Result<CalibrationOutcome>> outcome_;
  CoursePicture picture_;
};

} // namespace nendo::studio
