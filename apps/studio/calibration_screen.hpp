#pragma once
// A guided calibration in a window. Main thread.

#include <optional>
#include <utility>

#include "studio/calibration_course.hpp"
#include "viewer/scene_window.hpp"
#include "viewer/window_form.hpp"

namespace nendo::studio {

class CalibrationScreen {
public:
  /// As CalibrationCourse.
  CalibrationScreen(driver::Glove& glove, calibrate::CalibrationRequest request,
                    bool fresh = false);

  /// Starts the glove. Errors: those of driver::Glove::start().
  Result<void> start() { return course_.start(); }
  /// Draws one picture. Returns nothing while the calibration continues, also if the window is to
  /// be closed. Error: failed (the poses could not be kept).
  std::optional<Result<CalibrationOutcome>> show(viewer::SceneWindow& window);
  /// Ends at the next picture, as CalibrationCourse::leave().
  void leave() { course_.leave(); }
  /// As CalibrationCourse.
  bool has_unkept_poses() const { return course_.has_unkept_poses(); }

private:
  void look_by(viewer::SceneWindow& window);
  void draw_hands(viewer::SceneWindow& window);
  void draw_panel(const viewer::SceneWindow& window);
  void draw_words(const viewer::SceneWindow& window) const;
  void draw_ring(const viewer::SceneWindow& window) const;
  void draw_captions(const viewer::SceneWindow& window) const;

  CalibrationCourse course_;
  HandPainter painter_;
  viewer::WindowForm form_;
  render::Camera camera_;
  HostTime drawn_{}; ///< the previous picture
};

} // namespace nendo::studio
