#pragma once
// sim:touch, a simulated glove whose hand really touches the model: made here, because it takes
// gloves, hands and the model.

#include <memory>
#include <optional>
#include <string>

#include <nendo/driver/glove.hpp>
#include <nendo/flow/touching_hand.hpp>

namespace nendo::gloves {

/// Whether that GLOVE is one.
bool is_touching(const std::string& spec);

struct TouchingGlove {
  std::unique_ptr<driver::Glove> glove;
  Eigen::Isometry3d T_stage_wrist; ///< where its hand stands; a real glove would not know
};

/// For the hand of `side`, which has that size; without a side, for the one that `spec` says. Says
/// on standard error which fingers cannot reach the model. Errors: usage (an option), bad_input
/// (the model cannot be touched). Takes about 0.2 s.
Result<TouchingGlove> open_touching_glove(const std::string& spec, std::optional<Side> side,
                                          const deform::Mesh& model, const hand::HandSize& size);

} // namespace nendo::gloves
