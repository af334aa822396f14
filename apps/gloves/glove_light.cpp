#include "gloves/glove_light.hpp"

#include <thread>

namespace nendo::gloves {

void GloveLight::show(bool lit) noexcept {
  if (!exists() || lit == lit_) return;
  lit_ = lit;
  driver::Feedback feedback;
  feedback.light = lit;
  glove_.set_feedback(feedback);
}

void GloveLight::put_out() noexcept {
  if (!lit_) return;
  show(false);
  std::this_thread::sleep_for(std::chrono::milliseconds(250)); // Glove::set_feedback: within 0.2 s
}

} // namespace nendo::gloves
