#pragma once
// A control for each setting of a loop that works in its mode, from the settings' descriptions.

#include <cstdint>

#include <nendo/flow/loop_settings.hpp>

#include "forms/form.hpp"

namespace nendo::forms {

class SettingForm {
public:
  /// `place`: where the form is, which has keys (commands::in_window, commands::on_page).
  explicit SettingForm(std::uint8_t place) noexcept : place_(place) {}
  /// Describes the mode's choice.
  static void describe_modes(Form& form, flow::LoopSettings& chosen);
  /// Describes the controls of the other settings that work in that mode: those of single fingers
  /// if these differ.
  void describe(Form& form, flow::LoopSettings& chosen);

private:
  std::uint8_t place_;
  bool one_radius_ = true; ///< all fingers have the same
  bool one_brush_ = true;
};

} // namespace nendo::forms
