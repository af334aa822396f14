#pragma once
// A guided calibration in a window: who wears the glove, the poses as a hand to follow, and then
// how sure the result is, with a hand to try it. Main thread. Nothing blocks for longer than a
// picture: fits run beside.

#include <array>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>

#include "calibrate/findings.hpp"
#include "calibrate/guided_calibration.hpp"
#include "calibrate/pose_advice.hpp"
#include "calibrate/wearer_file.hpp"
#include "studio/calibration_scene.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::studio {

struct CalibrationOutcome {
  /// What was written; nothing: the wearer left, or discarded it.
  std::optional<calibrate::FinishedCalibration> finished{};
  std::filesystem::path written{}; ///< where; empty: nowhere
  std::filesystem::path earlier{}; ///< where the previous version is; empty: there was none
  std::size_t kept = 0;            ///< poses kept for the next time
  bool adapt = false;              ///< the run shall learn on, as with --adapt
};

class CalibrationScreen {
public:
  /// `request` is what the wearer finds filled in. With `fresh` it does not offer to continue an
  /// earlier session. `glove` must not have been started, and must outlive the screen.
  CalibrationScreen(driver::Glove& glove, calibrate::CalibrationRequest request,
                    bool fresh = false);
  ~CalibrationScreen(); ///< stops the glove; may wait for a fit
  CalibrationScreen(const CalibrationScreen&) = delete;
  CalibrationScreen& operator=(const CalibrationScreen&) = delete;

  /// Starts the glove. Errors: those of driver::Glove::start().
  Result<void> start();
  /// Draws one picture. Returns nothing while the calibration continues. Error: failed (the poses
  /// could not be kept).
  std::optional<Result<CalibrationOutcome>> show(viewer::SceneWindow& window);
  /// Ends at the next picture, as the button Leave does: without a calibration, but the poses are
  /// kept for the next time.
  void leave();

private:
  static constexpr double aside_m = 0.11;  ///< distance of the two hands from the middle
  static constexpr double touch_m = 0.004; ///< pads that are nearer touch
  enum class Stage : std::uint8_t { before, guiding, fitting, after };
  /// What the words above the hands say.
  struct Banner {
    std::string instruction, state;
    bool warns = false;
  };

  // calibration_screen.cpp
  void take_samples();
  void advance();
  void follow_name();
  void begin_guide();
  void begin_last_fit();
  void take_again();
  void keep_result();
  void look_by(viewer::SceneWindow& window);
  void draw_scene(viewer::SceneWindow& window);
  void draw_free_motion(viewer::SceneWindow& window);
  void draw_asked_pose(viewer::SceneWindow& window);
  void draw_result(viewer::SceneWindow& window);
  void add_live(viewer::SceneWindow& window, const hand::HandPose& pose, const Fingers& marked,
                bool is_wrong);
  hand::JointAngles live_angles(const hand::Calibration& calibration) const;
  double shown_ranges() const;
  Banner banner() const;
  Banner guide_banner() const;
  std::string trouble() const;
  // calibration_panel.cpp
  int covered_px() const;
  void draw_panel(const viewer::SceneWindow& window);
  void before_panel();
  void kind_buttons();
  void guide_panel();
  void guide_buttons();
  void chips();
  void after_panel();
  void legend() const;
  void pairs() const;
  void guide_keys();
  void draw_banner(const viewer::SceneWindow& window) const;
  void draw_ring(const viewer::SceneWindow& window) const;
  void draw_captions(const viewer::SceneWindow& window) const;

  driver::Glove& glove_;
  SampleRing ring_{1024};
  std::optional<GloveSample> latest_;
  HandPainter painter_;
  calibrate::CalibrationRequest request_;
  bool fresh_;
  bool adapt_ = false;
  Stage stage_ = Stage::before;
  std::string problem_; ///< what failed; empty: nothing

  // Before:
  std::array<char, 100> name_{};
  float length_mm_;
  std::vector<std::string> recent_names_;
  std::string touch_up_refusal_; ///< why there is nothing to touch up; empty: there is
  bool has_kept_ = false;        ///< an earlier session kept poses
  bool continues_ = true;

  std::optional<calibrate::WearerFile> file_;
  std::optional<calibrate::CalibrationGuide> guide_;
  std::optional<calibrate::GuidedCalibration> guided_;
  std::vector<calibrate::PoseAdvice> advice_;
  HostTime guiding_since_{};

  std::future<Result<calibrate::FinishedCalibration>> fitting_;
  std::optional<calibrate::FinishedCalibration> finished_;
  std::vector<calibrate::Finding> findings_;
  hand::HandPose report_pose_{};                     ///< the hand that shows certainties
  std::optional<hand::HandSkeleton> skeleton_;       ///< the wearer's
  std::array<std::optional<double>, 4> nearest_m_{}; ///< from the thumb's pad to each finger's
  std::optional<Result<CalibrationOutcome>> outcome_;
  render::Camera camera_;
  HostTime drawn_{}; ///< the previous picture
};

} // namespace nendo::studio
