#pragma once
// A calibration on a page: opens the glove, and closes it at the end. Main thread.

#include <future>
#include <memory>
#include <string>

#include "studio/calibration_course.hpp"
#include "studio/page_figures.hpp"
#include "studio/page_form.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

class PageCalibration {
public:
  /// Begins to open the glove in a thread of its own.
  explicit PageCalibration(std::string glove);

  /// Describes the controls and the hands. Returns Go to the start when it is over. Errors: those
  /// of open_glove() and of the course.
  Result<Wish> update(PageForm& form, PageFigures& figures);
  /// Returns the wearer whose gloves a run continues to learn; empty: no wearer.
  const std::string& learns_for() const noexcept { return learns_for_; }

private:
  std::string name_;
  std::future<Result<std::unique_ptr<driver::Glove>>> opening_;
  std::unique_ptr<driver::Glove> glove_;
  std::unique_ptr<CalibrationCourse> course_;
  std::string learns_for_;
};

} // namespace nendo::studio
