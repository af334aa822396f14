#pragma once
// The controls of a screen or of a run's panel. They are described for each picture again; a window
// draws them (viewer::WindowForm), and a page in a browser gets them as a message (web::PageForm).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "commands/commands.hpp"
#include "forms/drawing.hpp"
#include "render/image.hpp"

namespace nendo::forms {

class Form {
public:
  enum class Tone : std::uint8_t { plain, faint, warning, success, title };
  enum class Look : std::uint8_t { plain, chosen, grey, done };
  struct Choice {
    std::string_view name;
    std::string help;
    std::string_view picture{}; ///< a name for line_picture(); empty: none
  };
  struct Row {
    std::string text;
    bool is_faint = false;
  };

  virtual ~Form() = default;

  /// From now on, so many buttons, cards, boxes and choices share a line; 0: as many buttons,
  /// cards, boxes, numbers and lines of text as fit, each as wide as its text. At first it is 1.
  virtual void lines_of(std::size_t count) = 0;
  virtual void separator() = 0;
  /// `help` is a tooltip, also below; empty: none.
  virtual void text(std::string_view words, Tone tone = Tone::plain,
                    std::string_view help = {}) = 0;
  /// A line of a legend: a disc in a linear colour, and words.
  virtual void key(std::string_view words, const Eigen::Vector3f& colour) = 0;
  /// A title, and a faint note beside it.
  virtual void title(std::string_view words, std::string_view note) = 0;
  /// A header that opens and closes the controls that follow, until the next one. Returns whether
  /// they are to be described.
  virtual bool section(std::string_view name, std::string_view help, bool is_open_at_first) = 0;
  /// The latest values of a quantity in milliseconds, the newest last. A page draws its own ones.
  virtual void chart(std::string_view name, std::string_view help,
                     std::span<const float> values) = 0;
  /// How far the joints of a hand are bent, in degrees, thumb to little. A page knows its hands.
  virtual void bends(Side side, std::string_view help, std::span<const float> degrees) = 0;

  // The user has pressed or changed the control since the last picture, if they return true.

  virtual bool button(std::string_view name, std::string_view help, Look look = Look::plain) = 0;
  /// A button with a picture, which must remain at its address; null: it is not there yet.
  virtual bool card(std::string_view name, const render::Image* picture, std::string_view help,
                    bool is_chosen = false) = 0;
  /// The button of a command, or a box. A page executes the command by itself, and returns false.
  virtual bool command(const commands::Row& row, const commands::State& now) = 0;
  virtual bool box(std::string_view name, const commands::Row& row, const commands::State& now,
                   bool is_on) = 0;
  virtual bool check(std::string_view name, std::string_view help, bool& value) = 0;
  virtual bool choice(std::string_view name, std::string_view help,
                      std::span<const std::string_view> names, std::size_t& chosen) = 0;
  /// Buttons of which one is chosen, with pictures above their names.
  virtual bool one_of(std::string_view name, std::span<const Choice> choices,
                      std::size_t& chosen) = 0;
  virtual bool number(std::string_view name, std::string_view help, float& value, float min,
                      float max, std::string_view unit, int decimals = 0) = 0;
  virtual bool line(std::string_view name, std::string& value) = 0;
  /// Lines below each other, of which one is the present one. Returns the line that was clicked.
  virtual std::optional<std::size_t> list(std::string_view name, std::string_view help,
                                          std::span<const Row> rows, std::size_t present) = 0;
  /// A drawing as wide as the line. Returns what the user did with the pointer in it.
  virtual Pointer drawing(std::string_view name, std::string_view help, const Drawing& drawing) = 0;
  /// Returns whether the user may still hold the number that was changed last.
  virtual bool is_changing() const = 0;
};

} // namespace nendo::forms
