#pragma once
// What Type-1 and Type-2 have in common.

#include <cstddef>
#include <optional>

#include <nendo/deform/block_evaluator.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/deform/undo_memory.hpp>

namespace nendo::deform {

struct DeformerOptions {
  Supports supports = one_radius(1.0); ///< radii in model units
  CsrbfOptions csrbf{};
  EvaluationOptions evaluation{};
  /// Never fold: each step is made in links that are injective.
  std::optional<InjectiveOptions> injective{};
  /// Memory for undo(), 832 bytes for each block of 64 vertices that a step changed; 0: none.
  /// One more shape is kept with it.
  std::size_t undo_bytes = 0;
  /// And what it grows by. One deformer's alone; must outlive it.
  UndoMemory* undo_memory = nullptr;
};

} // namespace nendo::deform
