#pragma once
// The light at a glove's wrist, which a command switches on and off and leaves off.

#include <nendo/driver/glove.hpp>

namespace nendo::gloves {

class GloveLight {
public:
  /// `glove` must outlive this.
  explicit GloveLight(driver::Glove& glove) noexcept : glove_(glove) {}
  GloveLight(const GloveLight&) = delete;
  GloveLight& operator=(const GloveLight&) = delete;

  bool exists() const noexcept { return glove_.info().abilities.light; }
  bool is_lit() const noexcept { return lit_; }
  /// Switches the light on or off. Does nothing if the glove has no light. Does not block.
  void show(bool lit) noexcept;
  /// Switches the light off, if it is lit, and gives the reader thread the time to send that. Call
  /// it before the glove is stopped. Blocks for a quarter of a second if the light was lit.
  void put_out() noexcept;

private:
  driver::Glove& glove_;
  bool lit_ = false;
};

} // namespace nendo::gloves
