#pragma once
// The commands of `nendo edit` that do not change a timeline: they make, show and play one, and
// open the window. Each command prints, blocks and returns the exit code.

#include <optional>
#include <string>

#include "cli/command.hpp"
#include "timeline/timeline.hpp"

namespace nendo::edit {

struct MakeOptions {
  std::string take;
  std::string mesh; ///< empty means the recorded one
  std::string out;
  std::string tolerance = "5mm"; ///< one count of an 8-bit glove moves a fingertip by about 1 mm
  bool json = false;
};
int make_timeline(const MakeOptions& options);

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

/// Adds the command `nendo edit view`, which opens the window.
void add_timeline_view(cli::Command& edit);

} // namespace nendo::edit
