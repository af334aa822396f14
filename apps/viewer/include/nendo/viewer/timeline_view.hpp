#pragma once
// What a window about a timeline tells, and what a person at it wants. Plain data: the window knows
// no timelines, and who edits them no window.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nendo/hand/skeleton.hpp>
#include <nendo/viewer/dope_sheet.hpp>

namespace nendo::viewer {

struct TimelineView {
  std::string file; ///< where it is saved
  double duration_s = 0.0;
  double rate_hz = 90.0; ///< of its frames
  std::vector<StripLane> lanes;
  std::vector<StripMark> marks;

  double head_s = 0.0;
  bool playing = false;
  bool loops = false;
  double speed = 1.0;
  std::optional<StripKey> selected;
  bool at_selected = false; ///< the head is at its time, so that its fingers can be bent

  bool modified = false;
  bool can_undo = false;
  bool can_redo = false;
  double computed_s = 0.0; ///< so far there are shapes
  bool computing = false;
  bool shape_is_old = false; ///< the shape that is shown is of before the last edits
  bool exporting = false;
  std::string export_file; ///< where "Export" writes
  std::string message;     ///< of the last thing that was done; may be empty
  bool refused = false;    ///< it was not, and `message` says why
};

enum class EditCommand {
  play,
  to_begin,
  to_end,
  previous_key,
  next_key,
  previous_frame,
  next_frame,
  add_key,
  delete_key,
  copy_key,
  mirror,
  undo,
  redo,
  save,
  export_glb,
};

/// Tries, each in place of the one before, until `keep` or `drop`.
struct KeyDrag {
  StripKey key; ///< as it was numbered when it was taken
  double to_s = 0.0;
  bool copy = false;
};
struct TipDrag { ///< of the selected key
  hand::Finger finger = hand::Finger::index;
  Eigen::Vector3d target_m; ///< on the stage
};
struct KeyBlend { ///< of the selected key
  double factor = 0.0;
};
struct Retiming {
  double from_s = 0.0;
  double to_s = 0.0;
  double scale = 1.0;
};

/// What a person has done since the last picture, to be applied in this order.
struct EditActions {
  std::optional<std::optional<StripKey>> select; ///< that, or none
  std::optional<double> seek_s;
  std::optional<double> speed;
  std::optional<bool> loops;
  std::optional<std::variant<KeyDrag, TipDrag, KeyBlend>> tried;
  bool keep = false; ///< what was tried is as it should be
  bool drop = false;
  std::optional<Retiming> retiming;
  std::vector<EditCommand> commands;
  bool quit = false; ///< after all these; without saving, unless that is among them
};

} // namespace nendo::viewer
