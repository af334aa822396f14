#pragma once
// A drawing in a form: areas, lines, diamonds, words and pictures, in the colours of the theme. A
// window draws it by ImGui, and a page on a canvas. Lengths are pixels of a screen of scale 1, from
// the drawing's top left corner.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "render/image.hpp"

namespace nendo::forms {

struct Drawing {
  /// As a page's style sheet names them. `shade` is the accent, translucent.
  enum class Colour : std::uint8_t {
    window,
    control,
    field,
    line,
    ink,
    soft,
    chart,
    accent,
    shade
  };
  enum class Kind : std::uint8_t { area, line, diamond, words, picture };
  struct Shape {
    Kind kind;
    Colour colour;
    /// The corners of a convex area; the points of a line; the middle of a diamond; the middle of
    /// the words' left edge. Of a picture two opposite corners, which it fills from top to bottom
    /// with its middle, and two of the part that is visible.
    std::vector<Eigen::Vector2f> points;
    Colour rim = Colour::control; ///< the diamond's
    std::string words{};
    std::shared_ptr<const render::Image> picture{};
  };

  void rectangle(double x0, double y0, double x1, double y1, Colour colour);
  void area(std::vector<Eigen::Vector2f> corners, Colour colour);
  void line(std::vector<Eigen::Vector2f> points, Colour colour);
  void diamond(double x, double y, Colour colour, Colour rim);
  void text(double x, double middle, Colour colour, std::string words);
  /// Returns about how wide the words are: never much less.
  static double width_of(const std::string& words) noexcept;

  static constexpr double half_diamond = 7.0;

  double width = 0.0;  ///< stretched to the width of the line
  double height = 0.0; ///< kept
  bool takes_pointer = false;
  std::string tooltip{}; ///< at the pointer; empty: the control's help
  std::vector<Shape> shapes{};
};

/// What the user did with the pointer in a drawing since the last picture.
struct Pointer {
  /// That of the line, so that the next drawing is not stretched; 0: not known yet.
  double width = 0.0;
  std::optional<Eigen::Vector2d> at{}; ///< over the drawing, or anywhere while is_held
  bool is_pressed = false;             ///< the main button went down in the drawing
  bool is_held = false;                ///< and is still down
  double panned = 0.0;                 ///< to the right, with the middle button
  double wheel = 0.0;                  ///< steps; positive: away from the user
  bool has_control = false;            ///< Ctrl is down
};

} // namespace nendo::forms
