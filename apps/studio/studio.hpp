#pragma once
// The window of Nendo from glove to sculpture: a start, runs, timelines and calibrations, one after
// another in one window. Main thread, as window systems require.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "session/run_options.hpp"
#include "session/views.hpp"
#include "studio/studio_timeline.hpp"
#include "studio/wish.hpp"

namespace nendo::studio {

struct StudioOptions {
  session::ViewOptions view;
  std::optional<FirstTimeline> timeline;  ///< nothing: the start is shown first
  std::vector<NamedGlove> gloves;         ///< those that the command line names
  gloves::CalibrationOptions calibration; ///< that the start screen shows
};

class Studio {
public:
  virtual ~Studio() = default;

  /// Shows the start, a timeline or a calibration, until the user wants a run. Returns nothing if
  /// the user quits, a stop signal comes, or the pictures of ViewOptions::frames were shown.
  virtual std::optional<Shape> choose() = 0;
  /// Begins to show a run, as an observer, which is valid until the next call. `asks_to_save`: the
  /// user, and not the end of the run, decides where its shape goes.
  virtual session::Observer* observe(const session::RunOptions& run, bool asks_to_save) = 0;
  /// To be called after the run: returns whether the studio continues, with choose().
  virtual bool goes_on() = 0;
  /// Shows in the next screen that something failed.
  virtual void show_error(const std::string& message) = 0;
  /// Writes the last picture, if ViewOptions::screenshot asks for it. Error: failed.
  virtual Result<void> end() = 0;
};

/// Opens the window. Errors: failed (no screen, no OpenGL, or built without the window); the
/// message has a remedy.
Result<std::unique_ptr<Studio>> open_studio(const StudioOptions& options);

} // namespace nendo::studio
