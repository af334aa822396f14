#pragma once
// What a loop cannot change while it runs, and what people ask for that only a new loop can give.
// It goes on from the shape as it is, with the hands where they are; undo begins anew.

#include <array>
#include <optional>

#include <nendo/deform/wendland.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::flow {

struct LoopSettings {
  Mode mode = Mode::type1;
  deform::Wendland kernel = deform::Wendland::c2;
  std::array<double, 5> radius_m{}; ///< of each finger, on the stage, thumb to little finger

  friend bool operator==(const LoopSettings&, const LoopSettings&) = default;
};

struct LoopChange {
  std::optional<LoopSettings> settings{}; ///< to go on with, in place of those in force
  bool reset = false;                     ///< back to the model as it was loaded
  std::optional<bool> record{};           ///< whether the next loop is recorded

  bool asks_anything() const noexcept { return settings || reset || record; }
  /// What somebody wants besides: who says something last of the same thing is heard.
  void add(const LoopChange& later) noexcept {
    if (later.settings) settings = later.settings;
    if (later.record) record = later.record;
    reset = reset || later.reset;
  }
};

} // namespace nendo::flow
