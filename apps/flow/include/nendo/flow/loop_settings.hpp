#pragma once
// The settings that a person may change while a run goes on.

#include <array>

#include <nendo/deform/wendland.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::flow {

struct LoopSettings {
  Mode mode = Mode::type1;
  deform::Wendland kernel = deform::Wendland::c2;
  std::array<double, 5> radius_m{}; ///< of each finger, on the stage, thumb to little finger

  friend bool operator==(const LoopSettings&, const LoopSettings&) = default;
};

} // namespace nendo::flow
