#pragma once
// Which screen of the studio follows which, in the window and on the page. Main thread.

#include <optional>
#include <string>
#include <utility>

#include "studio/studio.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

class StudioFlow : public Studio {
public:
  bool goes_on() final;

protected:
  explicit StudioFlow(StudioOptions options) : options_(std::move(options)) {}

  /// Follows a wish to another screen, to a run, or to the end.
  void follow(const Wish& wish);
  /// Opens a model, a puppet, a recording or a timeline.
  void begin_with(const std::string& file);
  /// Returns the wanted run; nothing: none is wanted.
  std::optional<Shape> take_next();

  const StudioOptions options_;
  std::optional<Shape> next_;
  std::string learns_for_; ///< as in Shape
  bool is_over_ = false;

private:
  /// Calibrates this glove, or if none is named, the one that is there.
  void calibrate(NamedGlove glove);

  /// Returns where the user went when the run was left.
  virtual Wish left_for() const = 0;
  /// Returns whether the timeline has edits that the user has neither saved nor discarded.
  virtual bool has_edits_to_lose() const = 0;
  virtual void begin_run(const Shape& shape) { next_ = shape; }
  /// Opens the file; without its name, asks for one.
  virtual void open(const Open& wanted) = 0;
  /// Returns the glove that the start shows, or none.
  virtual NamedGlove found_glove() const = 0;
  /// Ends the screen that is shown, and so closes its gloves. The start follows.
  virtual void leave_screen() = 0;
  /// Shows a recording or a timeline; without a file, the one that is open.
  virtual void enter_timeline(const std::string& file) = 0;
  virtual void enter_calibration(const NamedGlove& glove) = 0;
};

} // namespace nendo::studio
