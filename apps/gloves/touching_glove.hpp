#pragma once
// Makes what open_glove() needs for `sim:touch`, a simulated glove whose hand touches the model.

#include <optional>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/touching_hand.hpp>

namespace nendo::gloves {

/// Returns the context in which open_glove() can open `sim:touch` on `model`, for the hand of
/// `side`, which has that size. Without a side, it is for the hand that the specification names.
/// Opening such a glove takes about 0.2 s, sets `T_stage_wrist` to the place of its hand, which a
/// real glove would not know, and says on standard error which fingers cannot reach the model.
/// Opening fails with bad_input if the model cannot be touched. `model` and `T_stage_wrist` must
/// outlive the opening.
driver::GloveContext touching_context(const deform::Mesh& model, std::optional<Side> side,
                                      const hand::HandSize& size,
                                      std::optional<Eigen::Isometry3d>& T_stage_wrist);

} // namespace nendo::gloves
