#pragma once
// The versions of a model. A change of vertices or faces makes a new version outside the loop,
// which continues with it at a tick. An undo can return to the previous version.

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

/// The undo memory of a version: deform::DeformerOptions::undo_bytes, and by how many bytes it may
/// grow.
struct UndoSpace {
  std::size_t bytes = 0;
  std::size_t max_bytes = 0;
};

/// How a version was made from the previous one.
struct ModelOrigin {
  ModelSource source = ModelSource::kept;        ///< kept: it is the loop's initial model
  std::vector<deform::EdgeOperation> refining{}; ///< the operations, if it was refined
  deform::Points shape{}; ///< the previous version's shape in model units, if it is_of_shape()
  std::vector<deform::WirePlace> wire{}; ///< the wire that cut it
  double seam_width = 0.0;               ///< JoinParts::seam_width, if it was joined
  std::uint32_t part = 0;                ///< the copied or removed part
  /// The shape is a puppet's, and does not become the rest shape (kept_rest()).
  bool keeps_rest = false;
};
/// Makes a version again, at rest, from the previous version's mesh. Error: bad_input, without the
/// mesh's name.
NENDO_API Result<deform::Mesh> rebuild(const deform::Mesh& before, const ModelOrigin& origin);

// A model that is made from a deformed shape. With hands, the shape becomes the rest shape, which
// keeps their work. With a puppet, the shape is only its current state, and the rest shape is kept.

/// Returns the rest shape of `made`, which was made from the vertices `shape` with the rest shape
/// `rest` (3 by #vertices each). A vertex of `shape`, found by its index and position, or else by
/// its position, gets its rest position. New vertices get the mean of their neighbours'
/// displacements from shape to rest. A part without vertices of `shape` rests where it is. Takes up
/// to twice as long as a cut. Allocates. Deterministic, bit for bit.
NENDO_API deform::Points kept_rest(const deform::Mesh& made, const deform::Points& shape,
                                   const deform::Points& rest);

/// A version does not move in memory. Its const members are thread-safe.
struct NENDO_API ModelVersion {
  /// Allocates. `first`, if given, is the initial shape, in blocks of the layout.
  ModelVersion(std::uint32_t number, deform::Mesh mesh, deform::BlockLayout layout,
               const UndoSpace& undo, const deform::BlockShape* first);

  const deform::BlockLayout& layout() const noexcept { return shape.layout(); }

  const std::uint32_t number; ///< 0: the loop's initial model
  const deform::Mesh mesh;    ///< undeformed; a reset goes back to it
  /// Made when a brush first needs them. Asking thread only.
  std::shared_ptr<const deform::VertexRings> rings{};
  /// Made when hands first press clay, or move parts. Asking thread only.
  std::shared_ptr<const ClayModel> clay{};
  std::shared_ptr<const deform::ModelParts> parts{};
  std::shared_ptr<const ModelOrigin> origin = std::make_shared<ModelOrigin>();

  // Loop's thread while the loop uses this version, otherwise asking thread:
  std::unique_ptr<deform::UndoMemory> undo_memory; ///< null: the undo memory does not grow
  deform::SculptedShape shape;
  ModelVersion* before = nullptr; ///< an undo of this version's first step leads there
  ModelVersion* after = nullptr;  ///< a redo after this version's last step leads there
};

/// Returns an uninitialised shape of that version's size. Allocates.
NENDO_API deform::BlockShape space_for_shape(const ModelVersion& version);

/// A version in the making, which takes longer than a tick. Only finish() needs the shape.
class NENDO_API PendingModel {
public:
  /// Subdivides. Thread-safe, also while the loop runs. Allocates.
  explicit PendingModel(const ModelVersion& from);
  /// Prepares the change, which must be is_new(): subdivides, or prepares to refine, to cut by the
  /// wire, to join, to edit a part, or to change the topology. Error: bad_input, without the
  /// model's name.
  static Result<PendingModel> make(const ModelVersion& from, const ChangeModel& change,
                                   std::span<const deform::WirePlace> wire = {});

  bool is_of(const ModelVersion& version) const noexcept { return &version == from_; }
  /// Makes the version from the current shape of `from`: the loop must hold still. Call it once.
  /// With is_of_shape() and `keeps_rest`, a reset of the version restores the rest shape of `from`,
  /// otherwise the current shape. Allocates. Errors, to be appended to "the model": bad_input
  /// (nothing to refine, or nothing thin: found_nothing()), and those of deform::cut_model(),
  /// join(), copied_part(), removed_part() and change_topology().
  Result<std::unique_ptr<ModelVersion>> finish(std::uint32_t number, const UndoSpace& undo,
                                               bool keeps_rest = false);
  bool found_nothing() const noexcept { return found_nothing_; } ///< in finish()
  /// Returns whether it is made from the shape.
  bool is_of_shape() const noexcept { return std::holds_alternative<Remaking>(making_); }
  /// Returns the ChangeModel for the log.
  ChangeModel change_to(const ModelVersion& version) const noexcept;
  /// Returns deform::Refiner::count_unfit() of a shape of `from`. 0 unless it refines. Thread-safe.
  /// Allocates.
  std::size_t count_unfit(const deform::BlockShape& shape) const;

  /// The max number of face corners of a model that can be subdivided.
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
  /// A change with other faces, by rebuild().
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
