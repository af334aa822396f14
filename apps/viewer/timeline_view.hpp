#pragma once
// What a window for editing a timeline shows, and what the user wants to do there. These are plain
// data: the window does not know timelines, and the editor does not know the window.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/skeleton.hpp>

#include "commands/edit_command.hpp"

namespace nendo::viewer {

/// A hand's keys.
struct StripLane {
  Side side = Side::right;
  std::vector<double> keys_s; ///< in rising order
};

struct StripMark {
  double time_s = 0.0;
  std::string name;
};

struct StripKey {
  std::size_t lane = 0;
  std::size_t key = 0;
  friend bool operator==(const StripKey&, const StripKey&) = default;
};

/// The visible part of a timeline and its place on the strip: which time is at which pixel, counted
/// from the strip's top left corner, and which key or mark the pointer is at. From top to bottom,
/// the strip has a ruler, the lanes and the marks.
class DopeSheet {
public:
  static constexpr double left = 58.0;    ///< pixels for the names
  static constexpr double right = 14.0;   ///< pixels, enough for half a key
  static constexpr double ruler = 24.0;   ///< height
  static constexpr double lane = 26.0;    ///< height
  static constexpr double reach = 8.0;    ///< pixels from the pointer to a key or mark
  static constexpr double closest = 0.02; ///< seconds; the shortest part that can fill the strip

  static double height_for(std::size_t lanes) noexcept {
    return ruler + lane * static_cast<double>(lanes + 1);
  }

  /// Sets the strip's width in pixels and the timeline's duration. The visible part stays the same
  /// as far as it is within the duration. If all was visible, all stays visible.
  void fit(double width, double duration_s) noexcept;
  double first_s() const noexcept { return first_s_; } ///< the begin of the visible part
  double last_s() const noexcept { return last_s_; }   ///< its end
  double x_of(double time_s) const noexcept;
  /// Returns the time at x, limited to 0 and the duration.
  double time_at(double x) const noexcept;
  /// Returns the y of the middle of that lane. The number of lanes as `lane` gives the row of the
  /// marks.
  static double middle_of(std::size_t lane) noexcept;

  /// Zooms while the time under x stays there. Positive steps come closer.
  void zoom(double x, double steps) noexcept;
  void pan(double dx) noexcept;
  /// Moves the visible part so that it contains time_s, if it does not.
  void follow(double time_s) noexcept;

  /// Returns the key at the pointer, or the nearest if there are several.
  std::optional<StripKey> key_at(std::span<const StripLane> lanes, double x, double y) const;
  /// Returns the mark at the pointer, or the nearest if there are several.
  std::optional<std::size_t> mark_at(std::span<const StripMark> marks, std::size_t lanes, double x,
                                     double y) const;
  /// Returns the interval between the ruler's numbers: 1, 2 or 5 times a power of ten, so that the
  /// numbers do not overlap.
  double ruler_step_s() const noexcept;

private:
  void show(double first_s, double last_s) noexcept;
  double span_px() const noexcept;

  double width_ = 400.0;
  double duration_s_ = 0.0;
  double first_s_ = 0.0;
  double last_s_ = 1.0;
};

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
