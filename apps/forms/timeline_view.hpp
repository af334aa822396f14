#pragma once
// What the controls of a timeline show, and the user's actions there, as plain data. The controls
// are independent of timelines, and the editor of the controls.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/skeleton.hpp>

#include "commands/edit_command.hpp"
#include "render/image.hpp"

namespace nendo::forms {

/// A hand's keys.
struct StripLane {
  Side side = Side::right;
  std::vector<double> keys_s; ///< in rising order
};

/// A cell of the strip with a picture of the shape.
struct StripPicture {
  double from_s = 0.0;
  double to_s = 0.0;
  std::shared_ptr<const render::Image>
      image{}; ///< the shape in the cell's middle; null: not drawn yet
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

/// Maps the visible part of a timeline to pixels of the strip, from its top left corner, and finds
/// the key or mark at the pointer. From top to bottom, the strip has a ruler, pictures of the
/// shape, the lanes and the marks.
class DopeSheet {
public:
  static constexpr double left = 58.0;      ///< px, the width of the names
  static constexpr double right = 14.0;     ///< px, for half a key
  static constexpr double ruler = 24.0;     ///< height
  static constexpr double pictures = 56.0;  ///< height
  static constexpr double lane = 26.0;      ///< height
  static constexpr double narrowest = 70.0; ///< px, of a picture; the widest is twice as wide
  static constexpr double reach = 8.0;      ///< pixels from the pointer to a key or mark
  static constexpr double closest = 0.02;   ///< s, the shortest visible part

  static double height_for(std::size_t lanes) noexcept {
    return ruler + pictures + lane * static_cast<double>(lanes + 1);
  }

  /// Sets the strip's width in pixels and the timeline's duration. Keeps the visible part, limited
  /// to the duration. If all was visible, all stays visible.
  void fit(double width, double duration_s) noexcept;
  double first_s() const noexcept { return first_s_; } ///< the visible part's begin
  double last_s() const noexcept { return last_s_; }   ///< its end
  double x_of(double time_s) const noexcept;
  /// Returns the time at x, clamped to 0 and the duration.
  double time_at(double x) const noexcept;
  /// Returns the y of a lane's centre. With the number of lanes as `lane`, returns that of the
  /// marks.
  static double middle_of(std::size_t lane) noexcept;

  /// Zooms about the time at x. Positive steps zoom in.
  void zoom(double x, double steps) noexcept;
  void pan(double dx) noexcept;
  /// Scrolls so that time_s is visible, if it is not.
  void follow(double time_s) noexcept;

  /// Returns the nearest key at the pointer, if any.
  std::optional<StripKey> key_at(std::span<const StripLane> lanes, double x, double y) const;
  /// Returns the nearest mark at the pointer, if any.
  std::optional<std::size_t> mark_at(std::span<const StripMark> marks, std::size_t lanes, double x,
                                     double y) const;
  /// Returns the cells of the visible part, without their pictures. They have the same length, a
  /// power of two, but for the last one, which ends with the timeline. So they stay when the strip
  /// is panned, and every second one when it is zoomed.
  std::vector<StripPicture> cells() const;
  /// Returns the interval of the ruler's labels: 1, 2 or 5 times a power of ten, so that labels do
  /// not overlap.
  double ruler_step_s() const noexcept;

private:
  double length_within(double length_s) const noexcept;
  void show(double first_s, double last_s) noexcept;
  double span_px() const noexcept;

  double width_ = 400.0;
  double duration_s_ = 0.0;
  double first_s_ = 0.0;
  double last_s_ = 1.0;
};

/// The values of a puppet's function.
struct FunctionCurve {
  std::string name;
  double value = 0.0;           ///< at the play head
  std::vector<float> over_time; ///< at equal intervals over the timeline, as far as they are known
};

struct TimelineView {
  std::string file; ///< the timeline's file
  double duration_s = 0.0;
  double rate_hz = 90.0; ///< frames per second
  std::vector<StripLane> lanes;
  std::vector<StripMark> marks;
  std::vector<StripPicture> pictures;   ///< the cells that EditActions asked for
  std::vector<FunctionCurve> functions; ///< empty without a puppet

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

/// Trial edits. Each replaces the previous one, until EditActions::keep or EditActions::drop.
struct KeyDrag {
  StripKey key; ///< its indices at the beginning of the drag
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

/// The user's actions since the last picture, to be applied in this order.
struct EditActions {
  std::optional<StripKey> select;
  std::optional<double> seek_s;
  std::optional<double> speed;
  std::optional<std::variant<KeyDrag, TipDrag, KeyBlend>> tried;
  std::vector<StripPicture> cells; ///< the next view should have their pictures
  bool keep = false;               ///< the trial edit becomes a step
  bool drop = false;
  std::optional<Retiming> retiming;
  std::vector<EditCommand> commands;
  bool quit = false; ///< applied last
};

} // namespace nendo::forms
