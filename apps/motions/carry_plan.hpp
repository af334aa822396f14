#pragma once
// Hands that take the upper part of a model, after it was cut off or not.

#include "motions/knead_plan.hpp"

namespace nendo::motions {

enum class CutTool : std::uint8_t {
  wire,  ///< between both index fingertips, which lead it past the model
  knife, ///< at the tip of an index finger that points at the model
};

std::unique_ptr<KneadPlan> plan_to_carry(const KneadedModel& model,
                                         const hand::HandSkeleton& skeleton);
/// Cuts the upper part off, and then carries it.
std::unique_ptr<KneadPlan> plan_to_cut(CutTool tool, const KneadedModel& model,
                                       const hand::HandSkeleton& skeleton);

} // namespace nendo::motions
