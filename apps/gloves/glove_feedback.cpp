#include "gloves/glove_feedback.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

namespace nendo::gloves {
namespace {

// Steps of strength, so that a press that hardly changes does not pause the stream.
constexpr float levels = 8.0F;
// The weakest of these is still felt.
constexpr float min_vibration = 48.0F;

/// From 0 to 1, in steps. A touch is never none.
float level_of(float strength) noexcept {
  return strength > 0.0F ? std::ceil(std::min(strength, 1.0F) * levels) / levels : 0.0F;
}

} // namespace

void GloveFeedback::show(bool lit) noexcept {
  if (!glove_.info().abilities.light || lit == shown_.light) return;
  shown_.light = lit;
  glove_.set_feedback(shown_);
}

void GloveFeedback::feel(const flow::HandTouch& touch, HostTime now) noexcept {
  const driver::Abilities& can = glove_.info().abilities;
  if (!can.vibration && !can.resistance) return;
  if (now - felt_at_ < (can.vibration ? vibration_period : resistance_period)) return;
  driver::Feedback feedback = shown_;
  for (std::size_t at = 0; at < touch.size(); ++at) {
    const float level = level_of(touch[at]);
    if (can.vibration)
      feedback.vibration[at] = static_cast<std::uint8_t>(
          level > 0.0F ? min_vibration + level * (255.0F - min_vibration) : 0.0F);
    if (can.resistance && at < feedback.resistance.size())
      feedback.resistance[at] = static_cast<std::uint16_t>(1000.0F * level);
  }
  if (feedback == shown_) return;
  shown_ = feedback;
  felt_at_ = now;
  glove_.set_feedback(shown_);
}

void GloveFeedback::put_out() noexcept {
  if (shown_ == driver::Feedback{}) return;
  shown_ = {};
  glove_.set_feedback(shown_);
  std::this_thread::sleep_for(std::chrono::milliseconds(250)); // set_feedback(): within 0.2 s
}

} // namespace nendo::gloves
