#pragma once
// A control for each setting of a loop that works in its mode, from the settings' descriptions.

#include <nendo/flow/command.hpp>
#include <nendo/flow/loop_settings.hpp>

namespace nendo::viewer {

class SettingControls {
public:
  /// Shows radii and brushes of single fingers if these differ.
  void follow(const flow::PendingSettings& pending) noexcept;
  /// Draws the mode's choice.
  static void draw_modes(flow::LoopSettings& chosen);
  /// Draws the controls of the other settings that work in that mode.
  void draw(flow::LoopSettings& chosen);

private:
  bool one_radius_ = true; ///< all fingers have the same
  bool one_brush_ = true;
};

} // namespace nendo::viewer
