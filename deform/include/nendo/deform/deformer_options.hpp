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
  /// 1 or 2. The second thread spins from construction on and keeps a core busy; results are the
  /// same. Models of less than 3072 vertices use one thread only, and models of less than 8192 do
  /// with Type-1's weights.
  int threads = 1;
  /// The most memory for Type-1's weights. Where they need more, fields are evaluated instead,
  /// which takes about twice the time. Weights that leave the processor's caches gain nothing.
  std::size_t weight_bytes = std::size_t{4} << 20;
};

struct DeformerOptions {
  Supports supports = one_radius(1.0); ///< radii in model units
  CsrbfOptions csrbf{};
  EvaluationOptions evaluation{};
  /// If set, the model never folds: each step is made in links that are injective.
  std::optional<InjectiveOptions> injective{};
  /// What each start point does in type 2. Type 1 only pulls.
  BrushOptions brushes{};
  /// What holds vertices where they are; null: all are free. It must be of the shape's layout.
  std::shared_ptr<const VertexMask> mask{};
  /// Bytes of memory for undo, of which a step takes 832, and 832 for each block of 64 vertices
  /// that it changed. 0 means that nothing can be undone. The memory of one more shape comes on
  /// top.
  std::size_t undo_bytes = 0;
  /// Further memory for undo, or null. Each deformer needs its own, which must outlive it.
  UndoMemory* undo_memory = nullptr;
};

} // namespace nendo::deform
