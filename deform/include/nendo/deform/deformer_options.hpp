#pragma once
// The options that Type-1 and Type-2 have in common.

#include <cstddef>
#include <memory>
#include <optional>

#include <nendo/deform/brush.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/deform/vertex_mask.hpp>

namespace nendo::deform {

class UndoMemory;

struct EvaluationOptions {
  /// 1 or 2, with the same results. The second thread spins from construction on and keeps a core
  /// busy. Models with fewer than 3072 vertices, or with Type-1's weights 8192, use one thread
  /// only.
  int threads = 1;
  /// Max bytes of Type-1's weights. If they need more, fields are evaluated instead, which takes
  /// about twice the time. Weights that exceed the processor's caches save no time.
  std::size_t weight_bytes = std::size_t{4} << 20;
};

struct DeformerOptions {
  Supports supports = one_radius(1.0); ///< radii in model units
  CsrbfOptions csrbf{};
  EvaluationOptions evaluation{};
  /// If set, the model never folds: each step consists of injective links.
  std::optional<InjectiveOptions> injective{};
  /// The brush of each start point in type 2. Type 1 only pulls.
  BrushOptions brushes{};
  /// Weights that protect vertices; null: all are free. The mask must have the shape's layout.
  std::shared_ptr<const VertexMask> mask{};
  /// Bytes of undo memory. A step takes 832, plus 832 for each block of 64 vertices that it
  /// changed. 0 disables undo. The memory of one more shape is added to this.
  std::size_t undo_bytes = 0;
  /// Further memory for undo, or null. Each deformer needs its own, which must outlive it.
  UndoMemory* undo_memory = nullptr;
};

} // namespace nendo::deform
