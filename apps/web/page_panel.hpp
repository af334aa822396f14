#pragma once
// The panel of a run as a message for pages. One thread.

#include <optional>
#include <string>

#include <nendo/puppet/rig.hpp>

#include "forms/run_panel.hpp"
#include "web/page_form.hpp"

namespace nendo::web {

class PagePanel final : public forms::RunPanel {
public:
  PagePanel() noexcept : RunPanel(commands::on_page) {}

  /// Describes the controls again, and does to one of them what the input says, if there is one.
  /// `rig`: the run's puppet; null: none.
  void follow(std::optional<FormInput> input, const commands::Situation& now,
              const forms::DeviceLines& devices, const puppet::Rig* rig);
  /// Returns the message with the controls as they were described last.
  std::string message() const { return form_.message(); }

private:
  void describe_puppet(forms::Form& form, const flow::Frame& frame) override;

  PageForm form_;
  const puppet::Rig* rig_ = nullptr;
};

/// Returns the message for the status bar of the run.
std::string status_message(const flow::Frame& frame, double rate_hz, std::size_t vertices);

} // namespace nendo::web
