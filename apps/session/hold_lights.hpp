#pragma once
// Lights the LED of each glove while the hands hold the model, if the wrist switch does something.
// The main thread does it, because Glove::set_feedback takes a lock.

#include <memory>
#include <vector>

#include <nendo/flow/wrist_switch.hpp>

#include "gloves/glove_light.hpp"
#include "gloves/open_hand.hpp"

namespace nendo::session {

class HoldLights {
public:
  HoldLights(flow::SwitchAction action, const std::vector<gloves::OpenHand>& hands) {
    if (action == flow::SwitchAction::none) return;
    for (const auto& hand : hands)
      lights_.push_back(std::make_unique<gloves::GloveLight>(*hand.glove));
  }
  void show(bool held) noexcept {
    for (const auto& light : lights_)
      light->show(held);
  }
  void put_out() noexcept {
    for (const auto& light : lights_)
      light->put_out();
  }

private:
  std::vector<std::unique_ptr<gloves::GloveLight>> lights_;
};

} // namespace nendo::session
