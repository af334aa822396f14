#pragma once
// What Type-1 and Type-2 have in common.

#include <optional>

#include <nendo/deform/block_evaluator.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/supports.hpp>

namespace nendo::deform {

struct DeformerOptions {
  Supports supports = one_radius(1.0); ///< radii in model units
  CsrbfOptions csrbf{};
  EvaluationOptions evaluation{};
  /// Never fold: each step is made in links that are injective.
  std::optional<InjectiveOptions> injective{};
};

} // namespace nendo::deform
