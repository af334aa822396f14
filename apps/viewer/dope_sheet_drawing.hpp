#pragma once
// Draws the strip.

#include <optional>

#include <imgui.h>

#include "viewer/timeline_view.hpp"

namespace nendo::viewer {

struct StripLook {
  ImVec2 corner; ///< top left, in the window
  ImVec2 size;
  std::optional<StripKey> pointed_at;
  std::optional<Retiming> shaded; ///< highlighted times
};

void draw_strip(const DopeSheet& strip, const TimelineView& view, const StripLook& look);

} // namespace nendo::viewer
