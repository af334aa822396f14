#pragma once
// The light at a glove's wrist, as something that a command switches on and leaves dark.

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
  /// Does not block; nothing if the glove has no light.
  void show(bool lit) noexcept;
  /// Before the glove is stopped: puts a lit one out and gives the reader thread the time to say
  /// so. Blocks for a quarter of a second if it was lit.
  void put_out() noexcept;

private:
  driver::Glove& glove_;
  bool lit_ = false;
};

} // namespace nendo::gloves
