#pragma once
// A form in the current window of ImGui. Main thread.

#include <map>
#include <memory>

#include "gl/picture.hpp"
#include "studio/form.hpp"

namespace nendo::studio {

/// Returns the colour that marks success, as ImGui packs colours.
unsigned success_colour(float opacity = 1.0F);

class WindowForm final : public Form {
public:
  void lines_of(std::size_t count) override;
  void separator() override;
  void text(std::string_view words, Tone tone = Tone::plain) override;
  void key(std::string_view words, const Eigen::Vector3f& colour) override;
  void title(std::string_view words, std::string_view note) override;
  bool button(std::string_view name, std::string_view help, Look look = Look::plain) override;
  bool card(std::string_view name, const render::Image* picture, std::string_view help,
            bool is_chosen = false) override;
  bool check(std::string_view name, std::string_view help, bool& value) override;
  bool choice(std::string_view name, std::string_view help, std::span<const std::string_view> names,
              std::size_t& chosen) override;
  bool number(std::string_view name, std::string_view help, float& value, float min, float max,
              std::string_view unit) override;
  bool line(std::string_view name, std::string& value) override;

private:
  float next_width(std::string_view name);

  std::size_t in_line_ = 1, at_ = 0;
  float width_ = 0.0F; ///< the width of the controls of this line
  std::map<const render::Image*, std::unique_ptr<gl::Picture>> pictures_;
};

} // namespace nendo::studio
