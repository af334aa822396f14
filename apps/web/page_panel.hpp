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

  /// Returns the message (PROTOCOL.md, message 12), after the input, if any. `rig`: the run's
  /// puppet; null: none.
  std::string message(std::optional<FormInput> input, const commands::Situation& now,
                      const forms::DeviceLines& devices, const puppet::Rig* rig);

private:
  void describe_puppet(forms::Form& form, const flow::Frame& frame) override;

  PageForm form_;
  const puppet::Rig* rig_ = nullptr;
};

/// Returns the message for the status bar of the run.
std::string status_message(const flow::Frame& frame, double rate_hz, std::size_t vertices);

} // namespace nendo::web
