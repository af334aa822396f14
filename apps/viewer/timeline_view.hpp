#pragma once
// What a window for editing a timeline shows, and what the user wants to do there. These are plain
// data: the window does not know timelines, and the editor does not know the window.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nendo/hand/skeleton.hpp>

#include "commands/edit_command.hpp"
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
  double rate_hz = 90.0; ///< frames per second
  std::vector<StripLane> lanes;
  std::vector<StripMark> marks;
  std::vector<FunctionValue> functions; ///< at the play head; without a puppet there are none

  double head_s = 0.0;
  bool loops = false;
  double speed = 1.0;
  std::optional<StripKey> selected;
  bool at_selected = false; ///< the play head is at the selected key, whose fingers can be bent

  bool modified = false;
  commands::EditFacts facts;
  double computed_s = 0.0; ///< shapes exist up to this time
  bool computing = false;
  bool shape_is_old = false; ///< the visible shape was made before the last edits
  std::string message;       ///< about the last action; may be empty
  bool refused = false;      ///< the action was refused, and `message` has the reason
};

using commands::EditCommand;

/// A trial edit. Each one replaces the previous one, until EditActions::keep or EditActions::drop.
struct KeyDrag {
  StripKey key; ///< with its number at the beginning of the drag
  double to_s = 0.0;
  bool copy = false;
};
struct TipDrag { ///< a fingertip of the selected key
  hand::Finger finger = hand::Finger::index;
  Eigen::Vector3d target_m; ///< on the stage
};
struct KeyBlend { ///< the selected key and its neighbours
  double factor = 0.0;
};
struct Retiming {
  double from_s = 0.0;
  double to_s = 0.0;
  double scale = 1.0;
};

/// What the user has done since the last picture. It must be applied in this order.
struct EditActions {
  std::optional<StripKey> select;
  std::optional<double> seek_s;
  std::optional<double> speed;
  std::optional<std::variant<KeyDrag, TipDrag, KeyBlend>> tried;
  bool keep = false; ///< the tried edit becomes a step
  bool drop = false;
  std::optional<Retiming> retiming;
  std::vector<EditCommand> commands;
  bool quit = false; ///< after all others; saves only if `commands` has `save`
};

} // namespace nendo::viewer
