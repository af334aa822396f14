#pragma once
// What a glove shows its wearer: the light at the wrist, vibrators that report a touch, and brakes
// that hold fingers back. All of it is switched off at the end.

#include <nendo/driver/glove.hpp>
#include <nendo/flow/clay_hands.hpp>

namespace nendo::gloves {

class GloveFeedback {
public:
  /// A CyberTouch's stream pauses for each change, so that there are at most ten a second. What a
  /// wearer touches is felt at once, if nothing has changed for so long.
  static constexpr HostClock::duration vibration_period = std::chrono::milliseconds(100);
  static constexpr HostClock::duration resistance_period = std::chrono::milliseconds(20);

  /// `glove` must outlive this.
  explicit GloveFeedback(driver::Glove& glove) noexcept : glove_(glove) {}

  bool is_lit() const noexcept { return shown_.light; }
  /// Switches the light on or off. Does nothing if the glove has no light. Does not block, but may
  /// take a lock, so it is not for the loop's thread.
  void show(bool lit) noexcept;
  /// Lets the wearer feel what the hand touches: the harder it presses, the more. Does nothing if
  /// the glove can do nothing. What comes too soon after a change is left out; call it again with
  /// the newest. Does not block, as show().
  void feel(const flow::HandTouch& touch, HostTime now = HostClock::now()) noexcept;
  /// Switches all of it off, and gives the reader thread the time to send that. Call it before the
  /// glove is stopped. Blocks for a quarter of a second if anything was on.
  void put_out() noexcept;

private:
  driver::Glove& glove_;
  driver::Feedback shown_{};
  HostTime felt_at_{}; ///< the last change
};

} // namespace nendo::gloves
