#pragma once
// What the page shows of a glove beside its samples.

#include <array>

#include <nendo/driver/record_counts.hpp>

namespace nendo::web {

struct GloveState {
  driver::RecordCounts counts;
  bool uncalibrated = false; ///< its angles are an average hand's
};
/// By flow::Placement::index_of(side).
using GloveStates = std::array<GloveState, 2>;

} // namespace nendo::web
