#pragma once
// A puppet that is edited: what the user does with the mouse and keys in a window, as edits of the
// puppet that the loop plays. It draws nothing and knows no window. All lengths are in model units.
// For the main thread.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/puppet/puppet_edit.hpp>
#include <nendo/puppet/rig_check.hpp>

#include "viewer/pointing.hpp"

namespace nendo::viewer {

class PuppetEditor {
public:
  using RigPointer = std::shared_ptr<const puppet::Rig>;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  PuppetEditor();
  /// Begins with the model with which the loop began, whose file the puppet names so, and with the
  /// puppet that it plays; null: none.
  void begin(const deform::Mesh& loaded, const std::string& model_name, const RigPointer& rig);
  /// Another version of the model is shown.
  void set_model(const deform::Mesh& shown);
  /// Takes the puppet that the loop plays, which an undo may have changed, and looks at the hands:
  /// a finger that bends far enough moves the place that was clicked last.
  void follow(const RigPointer& current, const flow::Frame& frame);
  /// Returns, once, the puppet that the loop shall continue with; null: no other one.
  RigPointer take() { return std::exchange(to_loop_, nullptr); }

  bool is_on() const noexcept { return is_on_; }
  void turn(bool on);
  /// The model as it is to be shown: at rest, or with the function at 1 whose point is dragged.
  /// Null: as the hands have shaped it, while masks are painted for their fingertips.
  const deform::BlockShape* shape();
  /// Without a puppet: one that has no points.
  const puppet::Rig& rig() const noexcept { return *rig_; }
  const deform::Mesh& model() const noexcept { return shown_; }
  /// The model as it is shown: at rest, or, with masks of fingertips, as it was a moment ago.
  const deform::Mesh& seen() const noexcept { return is_live() ? live_ : shown_; }
  const std::string& message() const noexcept { return message_; } ///< the latest, for the user

  // Points. A place that was clicked waits for the finger that shall move it.

  void place(const SurfaceHit& hit);
  const std::optional<SurfaceHit>& pending() const noexcept { return pending_; }
  void forget_place();
  /// Says that the place that was clicked needs a finger before it can be dragged.
  void ask_for_finger();
  /// Lets that finger move the place that was clicked, or the chosen function.
  void choose_input(const puppet::HandSignal& input, double travel);
  /// Pins the place that was clicked, or pins the chosen point or lets it go.
  void toggle_pin();
  void choose_point(std::size_t point);
  void choose_function(std::size_t function);
  std::size_t point() const noexcept;    ///< that is chosen; none
  std::size_t function() const noexcept; ///< the chosen one, or one that moves the chosen point
  void remove_point();
  void rename_function(const std::string& name);
  void toggle_mirror();

  // The way of the chosen point in the chosen function.

  void begin_drag(std::size_t point);
  void drag(const Eigen::Vector3d& way);
  /// The same for the turn of the chosen function, that is, for all points that it turns. One that
  /// turns none gets a turn about the line to the viewer through the nearest pin, or, without pins,
  /// through the middle of the model.
  void begin_turn(std::size_t point, const Eigen::Vector3d& to_viewer);
  void turn_by(double degrees);
  /// The turn that is dragged; null: none.
  const puppet::AxisTurn* dragged_turn() const noexcept;
  void end_drag();
  bool is_dragging() const noexcept { return drag_.has_value(); }
  /// Returns where that point goes in the chosen function, while it is dragged.
  Eigen::Vector3d way_of(std::size_t point) const;

  /// Makes the radius of the chosen point, or of places to come, larger by so many tenths. The loop
  /// gets it when no further step has come for a while, so that it is one edit.
  void scale_radius(double steps);
  double radius() const noexcept; ///< the radius of the chosen point, or of places to come

  // The brush for masks.

  bool brushes() const noexcept { return brushes_; }
  void toggle_brush();
  /// Begins to paint what fingertips leave alone, or ends that.
  void toggle_masks();
  /// Returns whether it is on for that alone.
  bool paints_masks() const noexcept { return only_masks_; }
  /// Returns whether fingertips have masks, which are drawn whether they are edited or not.
  bool has_masks() const noexcept;
  void paint(const SurfaceHit& hit, bool erases);
  void end_stroke();
  const std::vector<Eigen::Vector3d>& stroke() const noexcept { return stroke_; }
  bool erases() const noexcept { return erases_; }
  double brush_radius() const noexcept { return brush_radius_; }

  /// Returns a number that changes when what is marked on the model does.
  std::uint64_t version() const noexcept { return version_; }
  /// The same for the model.
  std::uint64_t model_version() const noexcept { return model_version_; }

private:
  struct Drag {
    std::size_t point = none;
    std::size_t function = none;
    Eigen::Vector3d way;
    std::optional<puppet::AxisTurn> turn{}; ///< in place of the way
    deform::Points vectors{};               ///< the displacements by the turn
  };
  struct Scaling {
    std::size_t point = none;
    double radius = 1.0;
    HostTime last{};
  };
  bool is_live() const noexcept;
  void follow_shape(const flow::Frame& frame);
  bool apply(Result<puppet::Puppet> edited, const std::string& done);
  void set_rig(RigPointer rig, std::unique_ptr<puppet::RigShapes> shapes);
  Result<std::unique_ptr<puppet::RigShapes>> shapes_of(const RigPointer& rig) const;
  void look_at_hands(const flow::Frame& frame);
  void end_scaling(bool at_once);
  std::size_t mover_of(std::size_t point) const noexcept;
  Eigen::Vector3d pivot_of(std::size_t point) const;

  deform::Mesh loaded_, shown_;
  RigPointer rig_, empty_;
  RigPointer current_;           ///< in the loop, as follow() had it last
  std::vector<RigPointer> sent_; ///< to the loop, and not in effect yet
  RigPointer to_loop_;           ///< not taken yet
  std::unique_ptr<puppet::RigShapes>
      shapes_; ///< shapes of rig_ on shown_; null: none, or not made yet
  std::optional<deform::BlockShape> plain_;   ///< shown_ itself, where there is no puppet
  std::optional<deform::BlockLayout> layout_; ///< layout of shown_, if it was needed
  deform::Mesh live_;                         ///< shown_, as the hands have shaped it
  HostTime live_at_{};                        ///< when it was brought up to date
  std::string point_name_, function_name_;    ///< that are chosen
  std::optional<SurfaceHit> pending_;
  puppet::BendWatch bends_;
  std::optional<Drag> drag_;
  std::optional<Scaling> scaling_;
  std::vector<Eigen::Vector3d> stroke_;
  double new_radius_ = 1.0, brush_radius_ = 1.0;
  bool is_on_ = false, brushes_ = false, erases_ = false;
  bool only_masks_ = false; ///< it is on for them alone
  std::uint64_t version_ = 1, model_version_ = 1;
  std::string message_;
};

} // namespace nendo::viewer
