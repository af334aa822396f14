#pragma once
// A calibration as a screen of the studio: opens the glove, and closes it at the end. Main thread.

#include <future>
#include <memory>
#include <string>

#include "studio/calibration_screen.hpp"
#include "studio/wish.hpp"
#include "viewer/scene_window.hpp"

namespace nendo::studio {

class CalibrationVisit {
public:
  /// Begins to open the glove in a thread of its own.
  CalibrationVisit(viewer::SceneWindow& window, std::string glove);
  ~CalibrationVisit(); ///< closes the glove

  /// Draws one picture. Returns Go to the start when it is over. Errors: those of open_glove() and
  /// of the screen.
  Result<Wish> show(viewer::SceneWindow& window);
  /// Returns the wearer whose gloves a run continues to learn; empty: no wearer.
  const std::string& learns_for() const noexcept { return learns_for_; }

private:
  std::string name_;
  std::future<Result<std::unique_ptr<driver::Glove>>> opening_;
  std::unique_ptr<driver::Glove> glove_;
  std::unique_ptr<CalibrationScreen> screen_;
  std::string learns_for_;
};

} // namespace nendo::studio
