#pragma once
// The controls of a screen. A screen describes them for each picture again; the window draws them
// (WindowForm), and a page in a browser gets them as a message (PageForm).

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "render/image.hpp"

namespace nendo::studio {

class Form {
public:
  enum class Tone : std::uint8_t { plain, faint, warning, success, title };
  enum class Look : std::uint8_t { plain, chosen, grey, done };

  virtual ~Form() = default;

  /// From now on, so many buttons and cards share a line; 0: as many as fit, each as wide as its
  /// text. At first it is 1.
  virtual void lines_of(std::size_t count) = 0;
  virtual void separator() = 0;
  virtual void text(std::string_view words, Tone tone = Tone::plain) = 0;
  /// A line of a legend: a disc in a linear colour, and words.
  virtual void key(std::string_view words, const Eigen::Vector3f& colour) = 0;
  /// A title, and a faint note beside it.
  virtual void title(std::string_view words, std::string_view note) = 0;

  // The user has pressed or changed the control since the last picture, if they return true. `help`
  // is a tooltip; empty: none.

  virtual bool button(std::string_view name, std::string_view help, Look look = Look::plain) = 0;
  /// A button with a picture, which must remain at its address; null: it is not there yet.
  virtual bool card(std::string_view name, const render::Image* picture, std::string_view help,
                    bool is_chosen = false) = 0;
  virtual bool check(std::string_view name, std::string_view help, bool& value) = 0;
  virtual bool choice(std::string_view name, std::string_view help,
                      std::span<const std::string_view> names, std::size_t& chosen) = 0;
  virtual bool number(std::string_view name, std::string_view help, float& value, float min,
                      float max, std::string_view unit) = 0;
  virtual bool line(std::string_view name, std::string& value) = 0;
};

} // namespace nendo::studio
