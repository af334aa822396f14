#pragma once
// The commands of `nendo edit` that do not change a timeline: they make, show and play one. Each
// command prints, blocks and returns the exit code.

#include <optional>
#include <string>

#include <nendo/base/result.hpp>

#include "cli/command.hpp"
#include "timeline/reduce.hpp"

namespace nendo::edit {

struct MakeOptions {
  std::string take;
  std::string mesh; ///< empty means the recorded one
  std::string out;
  std::string tolerance = "5mm"; ///< one count of an 8-bit glove moves a fingertip by about 1 mm
  bool json = false;
};
int make_timeline(const MakeOptions& options);

/// A timeline of a recording, with its model.
struct TimelineOfTake {
  timeline::MadeTimeline made;
  deform::Mesh model;
  std::string first_shape{}; ///< the file that was written for it; empty: none
};
/// Makes a timeline that is to be saved in options.out. If the recording began in the middle of a
/// run, the shape of that moment is written into a file beside it, and is the timeline's model.
/// Blocks. Errors: those of takes::recorded_model(), takes::begin_with_first_shape() and
/// timeline::timeline_of_take().
Result<TimelineOfTake> timeline_of_take(const MakeOptions& options);

struct ShowOptions {
  std::string file;
  std::string finger;     ///< its tip's places are shown; empty means no finger
  bool functions = false; ///< the values of the puppet's functions are shown
  bool json = false;
};
int show_timeline(const ShowOptions& options);

struct PlayOptions {
  std::string file;
  std::string mesh; ///< empty means the timeline's
  std::string out;  ///< empty means that the shape is not written
  std::optional<double> until_s;
  double speed = 0.0; ///< times real time; 0 means as fast as possible
  bool json = false;
};
int play_timeline(const PlayOptions& options);

// These parse the arguments of the commands. All errors are usage errors that name the option and
// its possible values.

Result<Side> parse_hand(const std::string& text);
Result<hand::Finger> parse_finger(const std::string& text);
/// Parses three numbers after --to, such as "1,-2.5,0".
Result<Eigen::Vector3d> parse_place(const std::string& text);
/// Returns the path to which an edited timeline is written: `out`, or `file` itself if `out` is
/// empty. Errors: those of check_place(); usage if `file` is not named like a timeline.
Result<std::string> edited_file(const std::string& file, const std::string& out);
/// Parses a length or an angle: "1mm", "0.02rad" or "1deg".
Result<timeline::Tolerance> parse_tolerance(const std::string& text);

} // namespace nendo::edit
