#pragma once
// A form in the current window of ImGui. Main thread.

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "forms/form.hpp"
#include "gl/picture.hpp"
#include "viewer/window_drawing.hpp"

namespace nendo::viewer {

/// Returns the colour that marks success, as ImGui packs colours.
unsigned success_colour(float opacity = 1.0F);

class WindowForm final : public forms::Form {
public:
  void lines_of(std::size_t count) override;
  void separator() override;
  void text(std::string_view words, Tone tone = Tone::plain, std::string_view help = {}) override;
  void key(std::string_view words, const Eigen::Vector3f& colour) override;
  void title(std::string_view words, std::string_view note) override;
  bool section(std::string_view name, std::string_view help, bool is_open_at_first) override;
  void chart(std::string_view name, std::string_view help, std::span<const float> values) override;
  void bends(Side side, std::string_view help, std::span<const float> degrees) override;
  bool button(std::string_view name, std::string_view help, Look look = Look::plain) override;
  bool card(std::string_view name, const render::Image* picture, std::string_view help,
            bool is_chosen = false) override;
  bool command(const commands::Row& row, const commands::State& now) override;
  bool box(std::string_view name, const commands::Row& row, const commands::State& now,
           bool is_on) override;
  bool check(std::string_view name, std::string_view help, bool& value) override;
  bool choice(std::string_view name, std::string_view help, std::span<const std::string_view> names,
              std::size_t& chosen) override;
  bool one_of(std::string_view name, std::span<const Choice> choices, std::size_t& chosen) override;
  bool number(std::string_view name, std::string_view help, float& value, float min, float max,
              std::string_view unit, int decimals = 0) override;
  bool line(std::string_view name, std::string& value) override;
  std::optional<std::size_t> list(std::string_view name, std::string_view help,
                                  std::span<const Row> rows, std::size_t present) override;
  forms::Pointer drawing(std::string_view name, std::string_view help,
                         const forms::Drawing& drawing) override;
  bool is_changing() const override;

private:
  /// What a list showed in the last picture.
  struct Shown {
    std::size_t rows = 0, present = 0;
    std::string last; ///< the last row
    friend bool operator==(const Shown&, const Shown&) = default;
  };
  float next_width(std::string_view name);

  std::size_t in_line_ = 1, at_ = 0;
  float left_ = 0.0F, width_ = 0.0F; ///< the first column's, and each column's
  std::map<const render::Image*, std::unique_ptr<gl::Picture>> pictures_;
  std::map<std::string, Shown, std::less<>> lists_;
  std::map<std::string, WindowDrawing, std::less<>> drawings_;
};

} // namespace nendo::viewer
