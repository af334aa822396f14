#pragma once
// A calibration as a screen of the studio, in the window or on the page: opens the glove, and
// closes it at the end. Main thread.

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "studio/calibration_course.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

class CalibrationVisit {
public:
  /// Begins to open the glove in a thread of its own.
  explicit CalibrationVisit(NamedGlove glove);

  /// Returns the glove, which is valid as long as this; null: it is still being opened. Errors:
  /// those of open_glove().
  Result<driver::Glove*> glove();
  /// Returns what is to be shown until the glove is open.
  std::string waiting_words() const;
  /// Returns Go to the start once the calibration has an outcome. Error: that of the outcome.
  Result<Wish> follow(const std::optional<Result<CalibrationOutcome>>& outcome);
  /// Returns the wearer whose gloves a run continues to learn; empty: no wearer.
  const std::string& learns_for() const noexcept { return learns_for_; }

private:
  std::string name_; ///< the glove's
  std::future<Result<std::unique_ptr<driver::Glove>>> opening_;
  std::unique_ptr<driver::Glove> glove_;
  std::string learns_for_;
};

} // namespace nendo::studio
