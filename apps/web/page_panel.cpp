#include "web/page_panel.hpp"

#include <utility>

#include "forms/run_status.hpp"

namespace nendo::web {

void PagePanel::follow(std::optional<FormInput> input, const commands::Situation& now,
                       const forms::DeviceLines& devices, const puppet::Rig* rig) {
  rig_ = rig;
  form_.begin(std::move(input));
  form_.part("run");
  describe(form_, now, devices);
}

/// What each function listens to; puppets are edited in the window.
void PagePanel::describe_puppet(forms::Form& form, const flow::Frame&) {
  if (rig_ == nullptr || !rig_->puppet().is_played()) return;
  form.section("Puppet", "What each finger moves.", true);
  for (const puppet::Function& function : rig_->puppet().functions)
    form.text(function.name + ": " + function.input.name(), forms::Form::Tone::plain,
              "What the puppet does, and the finger that plays it.");
}

std::string status_message(const flow::Frame& frame, double rate_hz, std::size_t vertices) {
  PageForm form;
  form.begin({});
  form.part("status");
  for (const auto& [text, help] : forms::status_items(frame, rate_hz, vertices))
    form.text(text, forms::Form::Tone::plain, help);
  return form.message();
}

} // namespace nendo::web
