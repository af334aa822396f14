#include <nendo/flow/sculptor.hpp>

#include <algorithm>
#include <numeric>
#include <type_traits>

#include <nendo/base/text.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/hand/held_points.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

using deform::BlockShape;
using deform::FieldStatus;
using deform::HistoryMove;
using deform::Points;
using deform::SculptedShape;
using deform::Type1Deformer;
using deform::Type2Deformer;

namespace {

using Deformer =
    std::variant<Type1Deformer, Type2Deformer, deform::SurfaceDeformer, ClayHands, PartHands>;

constexpr Eigen::Index fingers = 5;

/// Returns the options for points all over the hands, each of which has its finger's supports.
/// Points of one bone move together, and need not be followed exactly where they come close. Links
/// rely on exact points, so injective deformers are not smoothed.
deform::DeformerOptions held_all_over(const SculptorOptions& options) {
  constexpr double smoothing = 1e-3;
  deform::DeformerOptions deformer = options.deformer;
  if (!deformer.injective) deformer.csrbf.smoothing = smoothing;
  deformer.supports.own.clear();
  for (const deform::OwnSupport& own : options.deformer.supports.own)
    for (std::size_t at = 0; at < hand::held_point_count; ++at)
      if (hand::held_points[at].finger == static_cast<std::size_t>(own.point % fingers))
        deformer.supports.own.push_back(
            {own.point / fingers * static_cast<Eigen::Index>(hand::held_point_count) +
                 static_cast<Eigen::Index>(at),
             own.support});
  return deformer;
}

/// Returns the options of type 1 without a puppet.
deform::DeformerOptions of_type1(const SculptorOptions& options, Eigen::Index control_points) {
  const bool all_over =
      options.points_of_hand() != fingers && control_points % options.points_of_hand() == 0;
  return all_over ? held_all_over(options) : options.deformer;
}

/// Returns the options with the brushes of these fingertips.
deform::DeformerOptions brushed(const SculptorOptions& options, Eigen::Index control_points) {
  deform::DeformerOptions deformer = options.deformer;
  if (!options.rings || control_points % fingers != 0) return deformer;
  deform::BrushOptions& brushes = deformer.brushes;
  for (Eigen::Index point = 0; point < control_points; ++point)
    brushes.of_points.push_back(options.brushes[static_cast<std::size_t>(point % fingers)]);
  brushes.strength = options.brush_strength;
  brushes.are_mirrored = options.mirror.has_value();
  brushes.rings = options.rings;
  return deformer;
}

Deformer make(SculptedShape& shape, Eigen::Index control_points, const SculptorOptions& options) {
  if (options.mode == Mode::clay && options.bodies && options.clay) {
    const auto radii = radii_on_stage(options.deformer.supports, options.bodies->units_per_metre());
    return ClayHands(shape, options.clay, options.bodies,
                     std::accumulate(radii.begin(), radii.end(), 0.0) / fingers, options.deformer,
                     options.mirror);
  }
  if (options.mode == Mode::parts && options.bodies && options.parts)
    return PartHands(shape, options.parts, options.bodies, options.deformer.mask);
  if (options.mode == Mode::type2 && options.surface) return Type2Deformer(shape, options.surface);
  if (options.mode == Mode::type2)
    return Type2Deformer(shape, control_points, options.piece_length,
                         brushed(options, control_points));
  if (options.surface) return deform::SurfaceDeformer(shape, options.surface);
  return Type1Deformer(shape, control_points, of_type1(options, control_points));
}

/// Calls the function for deformers of type 1, of type 2 or of whole hands, whose own functions
/// have different names.
template <class Of1, class Of2, class OfHands>
auto each(Deformer& deformer, const Of1& of_type1, const Of2& of_type2, const OfHands& of_hands) {
  return std::visit(
      [&](auto& one) {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, Type2Deformer>)
          return of_type2(one);
        else if constexpr (std::is_same_v<std::decay_t<decltype(one)>, ClayHands> ||
                           std::is_same_v<std::decay_t<decltype(one)>, PartHands>)
          return of_hands(one);
        else
          return of_type1(one);
      },
      deformer);
}

/// Calls `function` with the part that measures distances along the surface; without one, returns
/// `otherwise`.
template <class Value, class Function>
Value along_surface(const Deformer& deformer, Value otherwise, const Function& function) {
  if (const auto* type1 = std::get_if<deform::SurfaceDeformer>(&deformer)) return function(*type1);
  const auto* type2 = std::get_if<Type2Deformer>(&deformer);
  return type2 == nullptr || type2->along() == nullptr ? otherwise : function(*type2->along());
}

} // namespace

std::string_view name_of(Mode mode) noexcept {
  constexpr std::array<std::string_view, mode_count> names{"type1", "type2", "clay", "parts"};
  return names[static_cast<std::size_t>(mode)];
}

std::optional<Mode> mode_named(std::string_view name) noexcept {
  for (std::uint8_t mode = 0; mode < mode_count; ++mode)
    if (name == name_of(static_cast<Mode>(mode))) return static_cast<Mode>(mode);
  return std::nullopt;
}

std::string_view name_of(Hold hold) noexcept {
  return hold == Hold::hand ? "hand" : "tips";
}

std::optional<Hold> hold_named(std::string_view name) noexcept {
  if (name == "tips") return Hold::fingertips;
  if (name == "hand") return Hold::hand;
  return std::nullopt;
}

std::optional<std::array<deform::Brush, 5>> parse_brushes(std::string_view text) noexcept {
  std::array<deform::Brush, 5> brushes{};
  std::size_t count = 0;
  for (ItemReader items(text, ','); !items.has_ended(); ++count) {
    const auto brush = deform::brush_named(items.next());
    if (!brush || count == brushes.size()) return std::nullopt;
    brushes[count] = *brush;
  }
  if (count == 1) brushes.fill(brushes[0]);
  if (count != 1 && count != brushes.size()) return std::nullopt;
  return brushes;
}

std::string in_words(const std::array<deform::Brush, 5>& brushes) {
  std::string words(deform::name_of(brushes[0]));
  if (std::count(brushes.begin(), brushes.end(), brushes[0]) == fingers) return words;
  for (std::size_t finger = 1; finger < brushes.size(); ++finger)
    words += "," + std::string(deform::name_of(brushes[finger]));
  return words;
}

bool SculptorOptions::needs_rings() const noexcept {
  return !deform::are_all_pull(brushes);
}

Eigen::Index SculptorOptions::points_of_hand() const noexcept {
  const bool all_over =
      hold == Hold::hand && mode == Mode::type1 && !deformer.csrbf.keeps_volume() && !mirror;
  return all_over ? static_cast<Eigen::Index>(hand::held_point_count) : fingers;
}

Sculptor::Sculptor(SculptedShape& shape, Eigen::Index control_points,
                   const SculptorOptions& options)
    : shape_(&shape), deformer_(make(shape, control_points, options)),
      control_points_(control_points) {}

Mode Sculptor::mode() const noexcept {
  if (std::holds_alternative<ClayHands>(deformer_)) return Mode::clay;
  if (std::holds_alternative<PartHands>(deformer_)) return Mode::parts;
  return std::holds_alternative<Type2Deformer>(deformer_) ? Mode::type2 : Mode::type1;
}

FieldStatus Sculptor::grab(const Points& tips) noexcept {
  return counted(each(
      deformer_, [&](auto& type1) { return type1.grab(tips); },
      [&](Type2Deformer& type2) { return type2.begin(tips); },
      [&](auto& hands) { return hands.begin(tips); }));
}

FieldStatus Sculptor::shape_to(const Points& tips, bool ends, BlockShape& out) noexcept {
  const auto changed = [&](FieldStatus status) { // the deformer has changed the rest shape
    out.follow(rest());
    return status;
  };
  return each(
      deformer_, [&](auto& type1) { return type1.apply(tips, out); },
      [&](Type2Deformer& type2) {
        return changed((ends ? type2.end_at(tips) : type2.stroke_to(tips)).status);
      },
      [&](auto& hands) { return changed(hands.follow(tips, ends)); });
}

FieldStatus Sculptor::commit(const Points& tips) noexcept {
  return counted(each(
      deformer_, [&](auto& type1) { return type1.commit(tips); },
      [&](Type2Deformer& type2) { return type2.begin(tips); },
      [&](auto& hands) { return hands.begin(tips); }));
}

FieldStatus Sculptor::continue_grab(const Points& tips) noexcept {
  return counted(std::visit([&](auto& deformer) { return deformer.grab(tips); }, deformer_));
}

void Sculptor::continue_from(const Sculptor& before, bool keeps_volume) noexcept {
  auto* hands = std::get_if<ClayHands>(&deformer_);
  const ClayHands* hands_before = before.clay();
  if (hands != nullptr && hands_before != nullptr)
    hands->continue_from(*hands_before, keeps_volume);
}

void Sculptor::release(bool is_step) noexcept {
  std::visit([&](auto& deformer) { deformer.release(is_step); }, deformer_);
}

void Sculptor::drop(bool is_step) noexcept {
  each(
      deformer_, [&](auto& type1) { type1.drop(is_step); },
      [&](Type2Deformer& type2) { type2.release(is_step); },
      [&](auto& hands) { hands.release(is_step); });
}

FieldStatus Sculptor::apply_history(HistoryMove move, const Points& tips) noexcept {
  return counted(std::visit([&](auto& deformer) { return deformer.go(move, tips); }, deformer_));
}

FieldStatus Sculptor::undo_uncommitted(const Points& tips) noexcept {
  return counted(each(
      deformer_, [&](auto& type1) { return type1.take_back(tips); },
      [&](Type2Deformer& type2) { return type2.go(HistoryMove::undo, tips); },
      [&](auto& hands) { return hands.go(HistoryMove::undo, tips); }));
}

const deform::FieldSequence& Sculptor::fields() const noexcept {
  return std::visit(
      [](const auto& deformer) -> const deform::FieldSequence& { return deformer.fields(); },
      deformer_);
}

bool Sculptor::is_described_by_fields() const noexcept {
  if (const auto* type2 = std::get_if<Type2Deformer>(&deformer_))
    return !type2->is_brushed() && !type2->is_masked() &&
           !(type2->along() != nullptr && type2->along()->is_moved());
  if (const ClayHands* hands = clay()) return !hands->is_moved();
  if (const PartHands* hands = parts()) return !hands->is_moved();
  const auto* type1 = std::get_if<Type1Deformer>(&deformer_);
  return type1 != nullptr && !type1->is_masked();
}

void Sculptor::write_move(deform::SurfaceMove& move) const noexcept {
  const bool is_written = along_surface(deformer_, false, [&](const auto& surface) {
    surface.write_move(move);
    return true;
  });
  if (!is_written || (mode() == Mode::type2 && !moves_anything())) move.clear();
}

bool Sculptor::has_space(const deform::SurfaceMove& move) const noexcept {
  return along_surface(deformer_, true, [&](const auto& surface) {
    return move.vectors.cols() >= surface.vector_count();
  });
}

deform::SurfaceMove Sculptor::space_for_move() const {
  deform::SurfaceMove move;
  move.vectors.setZero(3, along_surface(deformer_, Eigen::Index{0}, [](const auto& surface) {
                         return surface.vector_count();
                       }));
  return move;
}

bool Sculptor::moves_anything() const noexcept {
  if (const ClayHands* hands = clay()) return hands->is_moved();
  if (const PartHands* hands = parts()) return hands->is_moved();
  if (along_surface(deformer_, false, [](const auto& surface) { return surface.is_moved(); }))
    return true;
  if (const auto* type2 = std::get_if<Type2Deformer>(&deformer_); type2 && type2->is_brushed())
    return true;
  const auto all = fields().fields();
  return std::any_of(all.begin(), all.end(), [](const deform::CsrbfField& field) {
    return !field.coefficients.isZero(0.0) || !field.polynomial.isZero(0.0);
  });
}

deform::ChainReport Sculptor::report() const noexcept {
  return std::visit([](const auto& deformer) { return deformer.report(); }, deformer_);
}

bool is_played(const puppet::Rig* rig) noexcept {
  return rig != nullptr && rig->puppet().is_played();
}

Eigen::Index control_points_of(const puppet::Rig* rig, const SculptorOptions& sculptor,
                               Eigen::Index hands) noexcept {
  if (is_played(rig)) return rig->starts().cols();
  return (sculptor.mirror ? 2 : 1) * sculptor.points_of_hand() * hands;
}

Eigen::Index supported_points(const puppet::Rig* rig, Eigen::Index hands) noexcept {
  if (is_played(rig)) return rig->starts().cols();
  return (mirror_of(rig) ? 10 : 5) * hands;
}

std::optional<double> mirror_of(const puppet::Rig* rig) noexcept {
  if (rig == nullptr || is_played(rig) || !rig->puppet().mirrors) return std::nullopt;
  return rig->puppet().mirror_at;
}

Result<void> check_points(const puppet::Rig* rig) {
  if (!is_played(rig) || rig->starts().cols() <= deform::CsrbfSolver::lean_size) return {};
  if (rig->puppet().distance == puppet::Distance::surface) return {};
  return Error{Errc::bad_input, "the puppet has " + std::to_string(rig->starts().cols()) +
                                    " points; a tick solves for at most " +
                                    std::to_string(deform::CsrbfSolver::lean_size) +
                                    " of them, unless distances go along the surface"};
}

void set_masks(const puppet::Rig* rig, const deform::Mesh& model, const deform::BlockLayout& layout,
               SculptorOptions& sculptor) {
  sculptor.mirror = mirror_of(rig);
  sculptor.deformer.mask =
      rig == nullptr ? nullptr : puppet::vertex_mask(rig->puppet(), layout, model.vertices);
}

Result<std::shared_ptr<const deform::SurfaceField>>
surface_for(const puppet::Rig& rig, const deform::Mesh& model, const deform::BlockLayout& layout,
            const deform::DeformerOptions& options) {
  if (!rig.puppet().is_played() || rig.puppet().distance == puppet::Distance::euclidean)
    return std::shared_ptr<const deform::SurfaceField>();
  deform::SurfaceSetup setup = puppet::surface_setup(rig.puppet(), model, options.csrbf.kernel);
  for (deform::SurfacePoint& point : setup.points)
    point.mix.clear();
  for (const deform::OwnSupport& own : options.supports.own)
    setup.points[static_cast<std::size_t>(own.point)].mix.push_back(own.support);
  for (deform::SurfacePoint& point : setup.points) // where all are equal, none has one of its own
    if (point.mix.empty()) point.mix = options.supports.shared;
  return deform::SurfaceField::make(model, layout, setup);
}

} // namespace nendo::flow
