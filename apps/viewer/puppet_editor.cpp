#include "viewer/puppet_editor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <nendo/deform/mesh.hpp>

namespace nendo::viewer {

using Eigen::Index;
using Eigen::Vector3d;
using puppet::HandSignal;
using puppet::Puppet;
using puppet::Rig;
using puppet::RigShapes;

namespace {

constexpr double radius_of_diagonal = 0.12; // of new points
constexpr double brush_of_diagonal = 0.04;
constexpr double way_of_radius = 0.35;  // of new functions, along the surface's normal
constexpr double factor_per_step = 1.1; // of the wheel
constexpr HostClock::duration wheel_rest = std::chrono::milliseconds(350);
constexpr double stroke_step = 0.3; // of the brush's radius, between places of a stroke

template <class List>
std::size_t number_named(const List& list, const std::string& name) noexcept {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
  return found == list.end() ? PuppetEditor::none : static_cast<std::size_t>(found - list.begin());
}

bool moves(const puppet::Function& function, std::size_t point) noexcept {
  return std::any_of(function.moves.begin(), function.moves.end(),
                     [&](const puppet::Move& move) { return move.point == point; });
}

} // namespace

PuppetEditor::PuppetEditor()
    : rig_(std::make_shared<const Rig>(Puppet{}, deform::Points(3, 0))), empty_(rig_) {}

void PuppetEditor::begin(const deform::Mesh& loaded, const std::string& model_name,
                         const RigPointer& rig) {
  loaded_ = loaded;
  const double diagonal = deform::diagonal_of(loaded.vertices);
  new_radius_ = radius_of_diagonal * diagonal;
  brush_radius_ = brush_of_diagonal * diagonal;
  empty_ = std::make_shared<const Rig>(puppet::empty_puppet(model_name), deform::Points(3, 0));
  current_ = rig;
  rig_ = rig ? rig : empty_;
  set_model(loaded);
}

void PuppetEditor::set_model(const deform::Mesh& shown) {
  shown_ = live_ = shown;
  layout_.reset();
  live_at_ = {};
  shapes_.reset();
  plain_.reset();
  ++version_;
  ++model_version_;
}

Result<std::unique_ptr<RigShapes>> PuppetEditor::shapes_of(const RigPointer& rig) const {
  if (rig->puppet().points.empty()) return std::unique_ptr<RigShapes>();
  return RigShapes::make(rig, shown_);
}

void PuppetEditor::set_rig(RigPointer rig, std::unique_ptr<RigShapes> shapes) {
  rig_ = std::move(rig);
  shapes_ = std::move(shapes);
  drag_.reset();
  ++version_;
}

void PuppetEditor::follow(const RigPointer& current, const flow::Frame& frame) {
  if (current != current_) {
    current_ = current;
    const auto known = std::find(sent_.begin(), sent_.end(), current);
    if (known != sent_.end()) {
      sent_.erase(sent_.begin(), known + 1);
    } else { // an edit was undone
      sent_.clear();
      set_rig(current ? current : empty_, nullptr);
    }
  }
  if (is_live()) follow_shape(frame);
  if (!edits_puppet()) return;
  look_at_hands(frame);
  end_scaling(false);
}

bool PuppetEditor::has_masks() const noexcept {
  const Puppet& puppet = rig_->puppet();
  return !puppet.is_played() && (!puppet.masks.empty() || puppet.inverted);
}

bool PuppetEditor::is_live() const noexcept {
  return edits_ == Edits::masks || (!is_on() && has_masks());
}

/// What is held does not move, so that a little later is soon enough; and the veils of a large
/// model take long.
void PuppetEditor::follow_shape(const flow::Frame& frame) {
  const HostClock::duration rest =
      std::chrono::milliseconds(250) * (1 + shown_.vertices.cols() / 100'000);
  const HostTime now = HostClock::now();
  if (frame.ticks_run == 0 || now - live_at_ < rest || !stroke_.empty()) return;
  if (!layout_) layout_.emplace(shown_.vertices);
  if (frame.shape.block_count() != layout_->block_count()) return;
  layout_->unpack(frame.shape, live_.vertices);
  live_at_ = HostClock::now();
  ++version_;
  ++model_version_;
}

void PuppetEditor::look_at_hands(const flow::Frame& frame) {
  if (!pending_ || frame.ticks_run == 0) return;
  std::array<puppet::HandState, 2> states;
  puppet::RigPlayer::Hands hands{};
  for (std::size_t slot = 0; slot < states.size(); ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    if (!hand.present) continue;
    states[slot] = {hand.angles, hand.pose, hand.T_stage_wrist};
    hands[slot] = &states[slot];
  }
  if (const auto bend = bends_.follow(hands)) choose_input(bend->input, bend->travel);
}

void PuppetEditor::turn(bool on) {
  end_scaling(true);
  forget_place();
  end_stroke();
  drag_.reset();
  edits_ = on ? Edits::points : Edits::nothing;
  message_ = on && rig_->puppet().points.empty()
                 ? "Click a place of the model that a finger shall move."
                 : "";
  ++version_;
}

const deform::BlockShape* PuppetEditor::shape() {
  if (edits_ == Edits::masks) return nullptr;
  if (!shapes_ && !rig_->puppet().points.empty()) {
    auto made = shapes_of(rig_);
    if (made) shapes_ = *std::move(made);
  }
  if (!shapes_) {
    if (!plain_) plain_ = deform::BlockLayout(shown_.vertices).pack();
    return &*plain_;
  }
  deform::Points places = rig_->starts();
  if (drag_) places += drag_->vectors;
  return &shapes_->blocks_with(places);
}

/// Returns false, and changes nothing, if the edit is refused, or if no field can be made of it.
bool PuppetEditor::apply(Result<Puppet> edited, const std::string& done) {
  const auto refuse = [&](const Error& error) {
    message_ = error.message;
    ++version_;
    return false;
  };
  if (!edited) return refuse(edited.error());
  auto rig = std::make_shared<const Rig>(*std::move(edited), loaded_);
  auto shapes = shapes_of(rig);
  if (!shapes) return refuse(shapes.error());
  set_rig(rig, *std::move(shapes));
  sent_.push_back(rig);
  to_loop_ = std::move(rig);
  message_ = done;
  return true;
}

std::size_t PuppetEditor::point() const noexcept {
  return number_named(rig_->puppet().points, point_name_);
}

/// The first function that moves it; none.
std::size_t PuppetEditor::mover_of(std::size_t point) const noexcept {
  const auto& functions = rig_->puppet().functions;
  for (std::size_t at = 0; at < functions.size(); ++at)
    if (moves(functions[at], point)) return at;
  return none;
}

std::size_t PuppetEditor::function() const noexcept {
  const std::size_t chosen = number_named(rig_->puppet().functions, function_name_);
  return chosen != none ? chosen : mover_of(point());
}

void PuppetEditor::choose_point(std::size_t point) {
  end_scaling(true);
  point_name_ = point == none ? "" : rig_->puppet().points[point].name;
  const auto& functions = rig_->puppet().functions;
  const std::size_t function = number_named(functions, function_name_);
  const std::size_t mover = mover_of(point);
  const bool moves_it = function != none && moves(functions[function], point);
  if (!moves_it && mover != none) function_name_ = functions[mover].name;
  ++version_;
}

/// Of twins, it is the one where the user has clicked.
void PuppetEditor::choose_new_point() {
  Index nearest = 0;
  (rig_->starts().colwise() - pending_->at).colwise().squaredNorm().minCoeff(&nearest);
  pending_.reset();
  choose_point(static_cast<std::size_t>(nearest));
}

void PuppetEditor::choose_function(std::size_t function) {
  function_name_ = rig_->puppet().functions[function].name;
  ++version_;
}

void PuppetEditor::place(const SurfaceHit& hit) {
  end_scaling(true);
  pending_ = hit;
  point_name_.clear();
  bends_.begin();
  ask_for_finger();
  ++version_;
}

void PuppetEditor::ask_for_finger() {
  message_ =
      "Bend the finger that shall move this place, or choose one below; then drag the place.";
}

void PuppetEditor::forget_place() {
  if (!pending_) return;
  pending_.reset();
  message_.clear();
  ++version_;
}

void PuppetEditor::choose_input(const HandSignal& input, double travel) {
  if (!pending_) {
    const std::size_t chosen = function();
    if (chosen == none) return;
    const std::string name = rig_->puppet().functions[chosen].name;
    apply(puppet::with_input(*rig_, chosen, input, travel), input.name() + " plays " + name + ".");
    return;
  }
  const Vector3d way = way_of_radius * new_radius_ * pending_->normal;
  if (!apply(puppet::with_function(*rig_, {pending_->at, new_radius_}, way, input, travel), ""))
    return;
  function_name_.clear();
  choose_new_point();
  message_ = input.name() + " moves " + point_name_ + ". Drag it to where it shall go.";
}

void PuppetEditor::toggle_pin() {
  if (pending_) {
    if (!apply(puppet::with_pin(*rig_, {pending_->at, new_radius_}), "")) return;
    choose_new_point();
    message_ = point_name_ + " stays where it is.";
    return;
  }
  const std::size_t chosen = point();
  if (chosen == none) return;
  const bool pinned = !rig_->puppet().points[chosen].is_pin;
  apply(puppet::with_pinned(*rig_, chosen, pinned),
        point_name_ + (pinned ? " stays where it is." : " may be moved."));
}

void PuppetEditor::remove_point() {
  const std::size_t chosen = point();
  if (pending_) return forget_place();
  if (chosen == none) return;
  scaling_.reset();
  if (apply(puppet::without_point(*rig_, chosen),
            point_name_ + " is gone; an undo brings it back."))
    point_name_.clear();
}

void PuppetEditor::rename_function(const std::string& name) {
  const std::size_t chosen = function();
  if (chosen == none || name == rig_->puppet().functions[chosen].name) return;
  if (apply(puppet::with_name(*rig_, chosen, name), "")) function_name_ = name;
}

void PuppetEditor::toggle_mirror() {
  if (rig_->puppet().points.empty()) {
    message_ = "A puppet begins with a point that a finger moves; then it can be mirrored.";
    return;
  }
  const bool mirrors = !rig_->puppet().mirrors;
  apply(puppet::with_mirror(*rig_, mirrors),
        mirrors ? "What is on one side is on both, and the other hand plays it."
                : "Each side has points and functions of its own.");
}

void PuppetEditor::begin_drag(std::size_t point) {
  choose_point(point);
  const std::size_t function = this->function();
  if (function == none || rig_->puppet().points[point].is_pin) return;
  drag_ = Drag{point, function, rig_->vectors_of(function)};
}

void PuppetEditor::drag(const Vector3d& way) {
  if (drag_) drag_->vectors.col(static_cast<Index>(drag_->point)) += way;
}

/// The nearest pin: a limb turns about its root.
Vector3d PuppetEditor::pivot_of(std::size_t point) const {
  const auto& starts = rig_->starts();
  const auto& points = rig_->puppet().points;
  const Vector3d from = starts.col(static_cast<Index>(point));
  const deform::Box box = deform::box_of_faces(loaded_);
  Vector3d pivot = 0.5 * (box.lowest + box.highest);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t at = 0; at < points.size(); ++at) {
    const Vector3d place = starts.col(static_cast<Index>(at));
    if (!points[at].is_pin || (place - from).norm() >= least) continue;
    least = (place - from).norm();
    pivot = place;
  }
  return pivot;
}

void PuppetEditor::begin_turn(std::size_t point, const Vector3d& to_viewer) {
  begin_drag(point);
  if (!drag_) return;
  const auto& known = rig_->puppet().functions[drag_->function].turn;
  drag_->turn = known ? *known : puppet::AxisTurn{0.0, to_viewer, pivot_of(point)};
  turn_by(0.0);
}

void PuppetEditor::turn_by(double degrees) {
  if (!drag_ || !drag_->turn) return;
  puppet::AxisTurn& turn = *drag_->turn;
  turn.degrees = std::clamp(turn.degrees + degrees, -360.0, 360.0);
  drag_->vectors = puppet::vectors_with_turn(*rig_, drag_->function, drag_->point, turn);
}

const puppet::AxisTurn* PuppetEditor::dragged_turn() const noexcept {
  return drag_ && drag_->turn ? &*drag_->turn : nullptr;
}

void PuppetEditor::end_drag() {
  if (!drag_) return;
  const Drag done = *std::exchange(drag_, {});
  if (done.turn) {
    const puppet::Function& function = rig_->puppet().functions[done.function];
    const double before = function.turn ? function.turn->degrees : 0.0;
    if (done.turn->degrees == before) return;
    const std::string name = function.name;
    apply(puppet::with_turn(*rig_, done.function, done.point, *done.turn),
          name + " turns by " + std::to_string(std::lround(done.turn->degrees)) + " degrees.");
    return;
  }
  const Vector3d before = rig_->vectors_of(done.function).col(static_cast<Index>(done.point));
  const Vector3d way = done.vectors.col(static_cast<Index>(done.point));
  if (way == before) return;
  apply(puppet::with_move(*rig_, done.function, done.point, way),
        rig_->puppet().functions[done.function].name + " moves " + point_name_ + " there.");
}

Vector3d PuppetEditor::way_of(std::size_t point) const {
  if (drag_) return drag_->vectors.col(static_cast<Index>(point));
  const std::size_t chosen = function();
  if (chosen == none) return Vector3d::Zero();
  return rig_->vectors_of(chosen).col(static_cast<Index>(point));
}

void PuppetEditor::scale_radius(double steps) {
  multiply_radius(std::pow(factor_per_step, std::clamp(steps, -10.0, 10.0)));
}

void PuppetEditor::multiply_radius(double factor) {
  const double diagonal = deform::diagonal_of(loaded_.vertices);
  const auto within = [&](double radius) {
    return std::clamp(radius * factor, 0.003 * diagonal, 2.0 * diagonal);
  };
  ++version_;
  if (brushes()) {
    brush_radius_ = within(brush_radius_);
    return;
  }
  const std::size_t chosen = pending_ ? none : point();
  if (chosen == none) {
    new_radius_ = within(new_radius_);
    return;
  }
  scaling_ = Scaling{within(radius()), HostClock::now()};
}

void PuppetEditor::end_scaling(bool at_once) {
  if (!scaling_ || (!at_once && HostClock::now() - scaling_->last < wheel_rest)) return;
  const double radius = std::exchange(scaling_, {})->radius;
  if (point() != none) apply(puppet::with_radius(*rig_, point(), radius), "");
}

double PuppetEditor::radius() const noexcept {
  const std::size_t chosen = pending_ ? none : point();
  if (chosen == none) return new_radius_;
  return scaling_ ? scaling_->radius : rig_->puppet().points[chosen].radius;
}

void PuppetEditor::toggle_brush() {
  if (loaded_.vertices.cols() == 0) return; // there is nothing to paint yet
  if (edits_ == Edits::masks) return turn(false);
  if (edits_ == Edits::masks_of_puppet) return turn(true);
  const bool is_of_puppet = is_on() && rig_->puppet().is_played();
  turn(true);
  edits_ = is_of_puppet ? Edits::masks_of_puppet : Edits::masks;
  message_ = "Drag over what " +
             std::string(is_of_puppet ? "shall stay as it is" : "fingertips shall leave as it is") +
             "; with shift, over what may move again. The wheel changes the brush.";
}

/// Masks are of the model before it was shaped.
void PuppetEditor::paint(const SurfaceHit& hit, bool erases) {
  const Vector3d at = hit.in_mesh.in(shown_.vertices);
  if (!stroke_.empty() && (stroke_.back() - at).norm() < stroke_step * brush_radius_) return;
  if (stroke_.empty()) erases_ = erases;
  stroke_.push_back(at);
  ++version_;
}

void PuppetEditor::end_stroke() {
  if (stroke_.empty()) return;
  const auto stroke = std::exchange(stroke_, {});
  // At three quarters of a mask's radius, places are held half.
  apply(erases_ ? puppet::without_masks(*rig_, stroke, brush_radius_)
                : puppet::with_masks(*rig_, stroke, brush_radius_ / puppet::half_of_mask),
        "");
}

} // namespace nendo::viewer
