#pragma once
// A calibration on a page. Main thread.

#include <memory>
#include <string>
#include <utility>

#include "studio/calibration_visit.hpp"
#include "studio/page_figures.hpp"
#include "web/page_form.hpp"

namespace nendo::studio {

using forms::Form;

class PageCalibration {
public:
  explicit PageCalibration(NamedGlove glove) : visit_(std::move(glove)) {}

  /// Describes the controls and the hands. Returns Go to the start when it is over. Errors: those
  /// of open_glove() and of the course.
  Result<Wish> update(web::PageForm& form, PageFigures& figures);
  bool has_unkept_poses() const {
    return course_ && course_->has_unkept_poses();
  } ///< as CalibrationCourse
  const std::string& learns_for() const noexcept {
    return visit_.learns_for();
  } ///< as CalibrationVisit

private:
  CalibrationVisit visit_;
  std::unique_ptr<CalibrationCourse> course_; ///< uses the visit's glove
};

} // namespace nendo::studio
