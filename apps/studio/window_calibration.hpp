#pragma once
// A calibration in the studio's window. Main thread.

#include <memory>
#include <string>

#include "studio/calibration_screen.hpp"
#include "studio/calibration_visit.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::studio {

class WindowCalibration {
public:
  WindowCalibration(viewer::SceneWindow& window, NamedGlove glove);

  /// Draws one picture. Returns Go to the start when it is over. Errors: those of open_glove() and
  /// of the screen.
  Result<Wish> show(viewer::SceneWindow& window);
  const std::string& learns_for() const noexcept {
    return visit_.learns_for();
  } ///< as CalibrationVisit

private:
  CalibrationVisit visit_;
  std::unique_ptr<CalibrationScreen> screen_; ///< uses the visit's glove
};

} // namespace nendo::studio
