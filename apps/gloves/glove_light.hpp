#pragma once
// The light at a glove's wrist, which a command switches on and off and leaves off.

#include <chrono>
#include <thread>

#include <nendo/driver/glove.hpp>

namespace nendo::gloves {

class GloveLight {
public:
  /// `glove` must outlive this.
  explicit GloveLight(driver::Glove& glove) noexcept : glove_(glove) {}

  bool is_lit() const noexcept { return lit_; }
  /// Switches the light on or off. Does nothing if the glove has no light. Does not block, but may
  /// take a lock, so it is not for the loop's thread.
  void show(bool lit) noexcept {
    if (!glove_.info().abilities.light || lit == lit_) return;
    lit_ = lit;
    driver::Feedback feedback;
    feedback.light = lit;
    glove_.set_feedback(feedback);
  }
  /// Switches the light off, if it is lit, and gives the reader thread the time to send that. Call
  /// it before the glove is stopped. Blocks for a quarter of a second if the light was lit.
  void put_out() noexcept {
    if (!lit_) return;
    show(false);
    std::this_thread::sleep_for(
        std::chrono::milliseconds(250)); // Glove::set_feedback: within 0.2 s
  }

private:
  driver::Glove& glove_;
  bool lit_ = false;
};

} // namespace nendo::gloves
