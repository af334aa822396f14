#pragma once
// The versions of a model. A change of its vertices or faces makes a new version, outside the loop,
// and the loop continues with it from one tick to the next. An undo goes back to the previous
// version.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/part_mover.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/subdivision.hpp>
#include <nendo/deform/undo_memory.hpp>
#include <nendo/deform/vertex_rings.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/flow/command.hpp>

namespace nendo::flow {

/// How much can be undone in a version: deform::DeformerOptions::undo_bytes, and by how many bytes
/// more that memory may grow.
struct UndoSpace {
  std::size_t bytes = 0;
  std::size_t max_bytes = 0;
};

/// How a version was made from the previous one.
struct ModelOrigin {
  ModelSource source = ModelSource::kept;        ///< kept: the loop began with it
  std::vector<deform::EdgeOperation> refining{}; ///< if it was refined
  deform::Points shape{}; ///< the previous version's shape in its model units, if it is_of_shape()
  std::vector<deform::WirePlace> wire{}; ///< that cut it
  double seam_width = 0.0;               ///< if it was joined
  std::uint32_t part = 0;                ///< that was copied or removed
  bool keeps_rest = false; ///< it is a puppet's, whose shape does not become the rest (kept_rest())
};
/// Makes that version of a mesh again, as it rests. Error: bad_input, without the mesh's name.
NENDO_API Result<deform::Mesh> rebuild(const deform::Mesh& before, const ModelOrigin& origin);

// A model that was made of a deformed shape: hands leave their work in the shape, so that it is the
// new model's rest. A puppet's shape is its state at that moment, and its rest stays.

/// Returns the rest of `made`, which was made of a mesh with these vertices and this rest (3 by
/// #vertices each). A vertex of the shape, which is known by its number and place, or by its place
/// where its number has changed, gets its rest; by the others the way from the shape to the rest is
/// spread evenly, each being the mean of its neighbours', and a part without any vertex of the
/// shape rests where it is. Takes up to twice as long as a cut, and allocates. The same bits for
/// the same arguments.
NENDO_API deform::Points kept_rest(const deform::Mesh& made, const deform::Points& shape,
                                   const deform::Points& rest);

/// A version does not move in memory. What is const is thread-safe.
struct NENDO_API ModelVersion {
  /// Allocates. With `first`, the shape is at first that one, in blocks of the layout.
  ModelVersion(std::uint32_t number, deform::Mesh mesh, deform::BlockLayout layout,
               const UndoSpace& undo, const deform::BlockShape* first);

  const deform::BlockLayout& layout() const noexcept { return shape.layout(); }

  const std::uint32_t number; ///< 0: the model with which the loop began
  const deform::Mesh mesh;    ///< undeformed; a reset goes back to it
  /// Made when a brush first needs them. Asking thread; the loop never looks.
  std::shared_ptr<const deform::VertexRings> rings{};
  /// Made when hands first press it, or move its parts. Asking thread.
  std::shared_ptr<const ClayModel> clay{};
  std::shared_ptr<const deform::ModelParts> parts{};
  std::shared_ptr<const ModelOrigin> origin = std::make_shared<ModelOrigin>();

  // Loop's thread while the loop has this version, and asking thread otherwise:
  std::unique_ptr<deform::UndoMemory> undo_memory; ///< null: it does not grow
  deform::SculptedShape shape;
  ModelVersion* before = nullptr; ///< an undo of the first step here leads to the last one there
  ModelVersion* after = nullptr;  ///< a redo of the last step here leads to the first one there
};

/// Returns a shape of that version's size, without its content. Allocates.
NENDO_API deform::BlockShape space_for_shape(const ModelVersion& version);

/// A version that is being made, which takes longer than a tick; only finish() needs the
/// shape.
class NENDO_API PendingModel {
public:
  /// Subdivides. Thread-safe, also while the loop runs. Allocates.
  explicit PendingModel(const ModelVersion& from);
  /// Subdivides, or makes ready to refine, to cut by that wire, to join, to edit a part,
  /// or to change the topology: what the change, which is_new(), says. Error: bad_input,
  /// without the model's name.
  static Result<PendingModel> make(const ModelVersion& from, const ChangeModel& change,
                                   std::span<const deform::WirePlace> wire = {});

  bool is_of(const ModelVersion& version) const noexcept { return &version == from_; }
  /// Makes the version, with the shape that `from` has now: the loop must hold still. May be called
  /// once. If it is_of_shape() and `keeps_rest`, a reset of the version goes back to the rest of
  /// `from`, and otherwise to the current shape. Allocates. Errors, to be appended to "the model":
  /// bad_input (nothing is left to refine, or thin: found_nothing()), and those of
  /// deform::cut_model(), join(), copied_part(), removed_part() and change_topology().
  Result<std::unique_ptr<ModelVersion>> finish(std::uint32_t number, const UndoSpace& undo,
                                               bool keeps_rest = false);
  bool found_nothing() const noexcept { return found_nothing_; } ///< finish() did
  /// Returns whether it is made of the shape.
  bool is_of_shape() const noexcept { return std::holds_alternative<Remaking>(making_); }
  /// Returns the change to that version.
  ChangeModel change_to(const ModelVersion& version) const noexcept;
  /// Of one that refines: deform::Refiner::count_unfit() of that shape of `from`.
  /// Thread-safe. Allocates.
  std::size_t count_unfit(const deform::BlockShape& shape) const;

  /// The corners of faces of the largest model that can be subdivided: 16 times, a triangle can.
  static constexpr std::size_t max_corners = std::size_t{6} << 20;

private:
  struct Subdividing {
    deform::Subdivision subdivision;
    deform::BlockLayout layout;
  };
  struct Refining {
    deform::Refiner refiner;
    deform::RefinementLimits limits;
  };
  /// Another shape becomes the model, with its own faces: what rebuild() makes of it.
  struct Remaking {
    ModelOrigin origin;
  };
  using Making = std::variant<Subdividing, Refining, Remaking>;
  PendingModel(const ModelVersion& from, Making making)
      : from_(&from), making_(std::move(making)) {}
  Result<std::unique_ptr<ModelVersion>> remade(Remaking& remaking, std::uint32_t number,
                                               const UndoSpace& undo, bool keeps_rest);

  const ModelVersion* from_;
  Making making_;
  bool found_nothing_ = false;
};

} // namespace nendo::flow
