#pragma once
// A calibration in the studio's window, which asks before its poses are lost. Main thread.

#include <memory>
#include <string>

#include "studio/bar.hpp"
#include "studio/calibration_screen.hpp"
#include "studio/calibration_visit.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::studio {

class WindowCalibration {
public:
  WindowCalibration(viewer::SceneWindow& window, Bar& bar, NamedGlove glove);

  /// Draws one picture. Returns Go to the start when it is over. Errors: those of open_glove() and
  /// of the screen.
  Result<Wish> show(viewer::SceneWindow& window);
  /// Returns whether the wish loses no poses. Otherwise asks the user, and take_settled() returns
  /// the wish later.
  bool lets(const Wish& wish);
  /// Returns the wish that waited for the answer, once the user discards the poses. To be called in
  /// each picture, after TimelineTab's.
  Wish take_settled();
  const std::string& learns_for() const noexcept {
    return visit_.learns_for();
  } ///< as CalibrationVisit

private:
  Bar& bar_;
  CalibrationVisit visit_;
  std::unique_ptr<CalibrationScreen> screen_; ///< uses the visit's glove
  Wish waiting_;
};

} // namespace nendo::studio
