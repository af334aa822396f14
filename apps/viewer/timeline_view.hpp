#pragma once
// What a window for editing a timeline shows, and what a person wants to do there. These are plain
// data: the window does not know timelines, and the editor does not know the window.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nendo/hand/skeleton.hpp>

#include "viewer/dope_sheet.hpp"

namespace nendo::viewer {

/// What a function of a puppet is at.
struct FunctionValue {
  std::string name;
  double value = 0.0;
};

struct TimelineView {
  std::string file; ///< where the timeline is saved
  double duration_s = 0.0;
  double rate_hz = 90.0; ///< of the frames
  std::vector<StripLane> lanes;
  std::vector<StripMark> marks;
  std::vector<FunctionValue> functions; ///< at the play head; without a puppet there are none

  double head_s = 0.0;
  bool playing = false;
  bool loops = false;
  double speed = 1.0;
  std::optional<StripKey> selected;
  bool at_selected = false; ///< the play head is at the selected key, whose fingers can be bent

  bool modified = false;
  bool can_undo = false;
  bool can_redo = false;
  double computed_s = 0.0; ///< shapes exist up to this time
  bool computing = false;
  bool shape_is_old = false; ///< the visible shape was made before the last edits
  bool exporting = false;
  std::string export_file; ///< where "Export" writes
  std::string message;     ///< about the last action; may be empty
  bool refused = false;    ///< the action was refused, and `message` tells why
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

/// A trial edit. Each one replaces the previous one, until EditActions::keep or EditActions::drop.
struct KeyDrag {
  StripKey key; ///< with its number at the beginning of the drag
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

/// What a person has done since the last picture. It must be applied in this order.
struct EditActions {
  std::optional<std::optional<StripKey>> select; ///< that key, or no key
  std::optional<double> seek_s;
  std::optional<double> speed;
  std::optional<bool> loops;
  std::optional<std::variant<KeyDrag, TipDrag, KeyBlend>> tried;
  bool keep = false; ///< the tried edit becomes a step
  bool drop = false;
  std::optional<Retiming> retiming;
  std::vector<EditCommand> commands;
  bool quit = false; ///< after all others; saves only if `commands` has EditCommand::save
};

} // namespace nendo::viewer
