#pragma once
// Edits the puppet that the loop plays, by mouse and key actions of a window. Independent of the
// window, and draws nothing. All lengths are in model units. Main thread.

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
  /// Begins with the loop's initial model, its file name for the puppet, and the played puppet;
  /// null: none.
  void begin(const deform::Mesh& loaded, const std::string& model_name, const RigPointer& rig);
  /// Sets the visible version of the model.
  void set_model(const deform::Mesh& shown);
  /// Updates the played puppet, which an undo may have changed, and evaluates the hands: a finger
  /// that bends far enough becomes the input of the pending place.
  void follow(const RigPointer& current, const flow::Frame& frame);
  /// Returns, once, the puppet with which the loop must continue; null: no change.
  RigPointer take() { return std::exchange(to_loop_, nullptr); }

  bool is_on() const noexcept { return edits_ != Edits::nothing; }
  /// Returns whether it edits a puppet, and not only masks of fingertips.
  bool edits_puppet() const noexcept { return is_on() && edits_ != Edits::masks; }
  void turn(bool on);
  /// Returns the shape to show: the rest shape, or, during a drag, the dragged function at 1. Null:
  /// the hands' shape, while masks of fingertips are painted.
  const deform::BlockShape* shape();
  /// Without a puppet, returns one without points.
  const puppet::Rig& rig() const noexcept { return *rig_; }
  const deform::Mesh& model() const noexcept { return shown_; }
  /// The visible model: at rest or, with masks of fingertips, in a recent shape.
  const deform::Mesh& seen() const noexcept { return is_live() ? live_ : shown_; }
  const std::string& message() const noexcept { return message_; } ///< the latest message

  // Points. A clicked place is pending until a finger is chosen for it.

  void place(const SurfaceHit& hit);
  const std::optional<SurfaceHit>& pending() const noexcept { return pending_; }
  void forget_place();
  /// Sets the message that the pending place needs a finger before a drag.
  void ask_for_finger();
  /// Sets the input of the pending place, or of the chosen function.
  void choose_input(const puppet::HandSignal& input, double travel);
  /// Pins the pending place, or pins or unpins the chosen point.
  void toggle_pin();
  void choose_point(std::size_t point);
  void choose_function(std::size_t function);
  std::size_t point() const noexcept;    ///< the chosen point, or `none`
  std::size_t function() const noexcept; ///< the chosen one, or one that moves the chosen point
  void remove_point();
  void rename_function(const std::string& name);
  void toggle_mirror();

  // The displacement of the chosen point by the chosen function.

  void begin_drag(std::size_t point);
  void drag(const Eigen::Vector3d& way);
  /// Begins a drag of the chosen function's rotation, for all points that it rotates. A function
  /// without a rotation gets one about the line of sight through the nearest pin or, without pins,
  /// through the model's centre.
  void begin_turn(std::size_t point, const Eigen::Vector3d& to_viewer);
  void turn_by(double degrees);
  /// Returns the dragged rotation; null: none.
  const puppet::AxisTurn* dragged_turn() const noexcept;
  void end_drag();
  bool is_dragging() const noexcept { return drag_.has_value(); }
  /// Returns a point's displacement by the chosen function, during a drag.
  Eigen::Vector3d way_of(std::size_t point) const;

  /// Increases the radius of the chosen point, or of new places, by `steps` tenths. The loop gets
  /// it when no step has come for a while, so that it is one edit.
  void scale_radius(double steps);
  void multiply_radius(double factor); ///< does the same by a factor
  double radius() const noexcept;      ///< the radius of the chosen point, or of new places

  // The brush for masks.

  bool brushes() const noexcept { return edits_ >= Edits::masks_of_puppet; }
  /// Begins or ends painting masks: of the puppet that is edited, or else of fingertips.
  void toggle_brush();
  /// Returns whether fingertips have masks. They are always drawn.
  bool has_masks() const noexcept;
  void paint(const SurfaceHit& hit, bool erases);
  void end_stroke();
  const std::vector<Eigen::Vector3d>& stroke() const noexcept { return stroke_; }
  bool erases() const noexcept { return erases_; }
  double brush_radius() const noexcept { return brush_radius_; }

  /// Returns a number that changes with the marks on the model.
  std::uint64_t version() const noexcept { return version_; }
  /// Returns a number that changes with the model.
  std::uint64_t model_version() const noexcept { return model_version_; }

private:
  struct Drag {
    std::size_t point = none;
    std::size_t function = none;
    deform::Points vectors; ///< displacements of all points, with the drag so far
    std::optional<puppet::AxisTurn> turn{};
  };
  struct Scaling {
    double radius = 1.0; ///< the chosen point's
    HostTime last{};
  };
  enum class Edits : std::uint8_t { nothing, points, masks_of_puppet, masks };
  bool is_live() const noexcept;
  void follow_shape(const flow::Frame& frame);
  bool apply(Result<puppet::Puppet> edited, const std::string& done);
  void set_rig(RigPointer rig, std::unique_ptr<puppet::RigShapes> shapes);
  Result<std::unique_ptr<puppet::RigShapes>> shapes_of(const RigPointer& rig) const;
  void look_at_hands(const flow::Frame& frame);
  void end_scaling(bool at_once);
  void choose_new_point();
  std::size_t mover_of(std::size_t point) const noexcept;
  Eigen::Vector3d pivot_of(std::size_t point) const;

  deform::Mesh loaded_, shown_;
  RigPointer rig_, empty_;
  RigPointer current_;           ///< the loop's puppet at the last follow()
  std::vector<RigPointer> sent_; ///< puppets sent to the loop, not in effect yet
  RigPointer to_loop_;           ///< take() returns it next
  std::unique_ptr<puppet::RigShapes>
      shapes_; ///< shapes of rig_ on shown_; null: none, or not made yet
  std::optional<deform::BlockShape> plain_;   ///< shown_, if there is no puppet
  std::optional<deform::BlockLayout> layout_; ///< the layout of shown_, made when needed
  deform::Mesh live_;                         ///< shown_ in the hands' shape
  HostTime live_at_{};                        ///< the time of the last update of live_
  std::string point_name_, function_name_;    ///< the chosen ones
  std::optional<SurfaceHit> pending_;
  puppet::BendWatch bends_;
  std::optional<Drag> drag_;
  std::optional<Scaling> scaling_;
  std::vector<Eigen::Vector3d> stroke_;
  double new_radius_ = 1.0, brush_radius_ = 1.0;
  Edits edits_ = Edits::nothing;
  bool erases_ = false;
  std::uint64_t version_ = 1, model_version_ = 1;
  std::string message_;
};

} // namespace nendo::viewer
