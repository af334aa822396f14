#pragma once
// Buttons, fields and choices of the windows: a label at the left of a field, and text that fits.
// Each notes its name and rectangle, so that tests press it by its name, and find what overlaps.
// Main thread. Does not include ImGui, which tests do not have.

#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "forms/setting_pictures.hpp"

namespace nendo::viewer {

/// A control of the current picture, as far as it can be seen.
struct Control {
  std::string name;
  Eigen::Vector2f min, max; ///< pixels from the window's top left corner
  bool is_possible = true;
  bool is_cut = false; ///< its text is wider than it, or it is wider than what it is in
};
/// Returns the controls that were drawn since forget_controls(). Main thread.
std::span<const Control> controls() noexcept;
void forget_controls() noexcept;
/// Returns the tooltip of the current picture; empty: none.
const std::string& tooltip() noexcept;
/// Replaces the file that the environment variable NENDO_CONTROLS names, if there is one, by a line
/// for each control: min x, min y, max x, max y, 1 or 0 for is_possible, and the name. By it a
/// program that moves the mouse finds what to press. Main thread; blocks for the file.
void write_controls();

/// Shows a tooltip for the latest item, also where it is grey.
void show_text(std::string_view text);
/// Notes the latest item of ImGui. text: what it shows. around: the width beside the text.
void note_control(std::string_view name, std::string_view text, float around = 0.0F);

/// Width 0: as wide as its text. A chosen one has the accent's colour.
bool button(std::string_view name, float width = 0.0F, bool is_possible = true,
            bool is_chosen = false);
/// A box with its name at the right.
bool check(std::string_view name, bool& value);
/// A header that opens and closes what follows it. Returns whether it is open.
bool section(std::string_view name, std::string_view help, bool is_open_at_first);

/// A button with lines above its name, stretched to its width; null: a plain button.
bool picture_button(std::string_view name, const forms::LinePicture* picture, float width,
                    bool is_chosen);

/// A number that is dragged, typed after a double click, or changed by the wheel with ctrl;
/// `format` says what it is. Width 0: the rest of the line.
bool bar_field(std::string_view name, float& value, float min, float max, const char* format,
               float width);

// Fields with a label at the left, both of which are the latest item:

bool number_field(std::string_view label, float& value, float min, float max, const char* format);
/// A text of at most text.size() - 1 bytes; it ends with 0.
bool text_field(std::string_view label, std::span<char> text);
/// A list of names, of which one is chosen.
bool choice_field(std::string_view label, std::span<const std::string_view> names,
                  std::size_t& chosen);

/// Returns the width of each of `count` controls in a line.
float share_of_line(std::size_t count);

} // namespace nendo::viewer
