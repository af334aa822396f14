#pragma once
// A form whose user is the test: it notes what is described, and answers as the test has asked.

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "forms/form.hpp"

namespace nendo::test {

class AnsweringForm final : public forms::Form {
public:
  // The user's input to the next description.
  std::string pressed;                    ///< the name of a button, a command or a box
  std::map<std::string, float> typed;     ///< numbers, by the names of their controls
  forms::Pointer pointer{.width = 800.0}; ///< in drawings that take it
  bool changes = false;

  // What was described, by the controls' names.
  std::vector<std::string> names;
  std::map<std::string, forms::Drawing> drawings;

  std::size_t count_of(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::count(names, name));
  }

  void lines_of(std::size_t) override {}
  void separator() override {}
  void text(std::string_view words, Tone, std::string_view) override { names.emplace_back(words); }
  void key(std::string_view words, const Eigen::Vector3f&) override { names.emplace_back(words); }
  void title(std::string_view words, std::string_view) override { names.emplace_back(words); }
  bool section(std::string_view name, std::string_view, bool) override {
    return note(name) || true;
  }
  void chart(std::string_view name, std::string_view, std::span<const float>) override {
    note(name);
  }
  void bends(Side, std::string_view, std::span<const float>) override {}
  bool button(std::string_view name, std::string_view, Look look) override {
    return note(name) && look != Look::grey;
  }
  bool card(std::string_view name, const render::Image*, std::string_view, bool) override {
    return note(name);
  }
  bool command(const commands::Row& row, const commands::State&) override { return note(row.name); }
  bool box(std::string_view name, const commands::Row&, const commands::State&, bool) override {
    return note(name);
  }
  bool check(std::string_view name, std::string_view, bool& value) override {
    const bool is_pressed = note(name);
    value = value != is_pressed;
    return is_pressed;
  }
  bool choice(std::string_view name, std::string_view, std::span<const std::string_view>,
              std::size_t&) override {
    return note(name) && false;
  }
  bool one_of(std::string_view name, std::span<const Choice>, std::size_t&) override {
    return note(name) && false;
  }
  bool number(std::string_view name, std::string_view, float& value, float min, float max,
              std::string_view, int) override {
    note(name);
    const auto found = typed.find(std::string(name));
    if (found == typed.end()) return false;
    value = std::clamp(found->second, min, max);
    return true;
  }
  bool line(std::string_view name, std::string&) override { return note(name) && false; }
  std::optional<std::size_t> list(std::string_view name, std::string_view, std::span<const Row>,
                                  std::size_t) override {
    note(name);
    return std::nullopt;
  }
  forms::Pointer drawing(std::string_view name, std::string_view,
                         const forms::Drawing& drawing) override {
    note(name);
    drawings[std::string(name)] = drawing;
    return drawing.takes_pointer ? pointer : forms::Pointer{.width = 200.0};
  }
  bool is_changing() const override { return changes; }

private:
  /// Returns whether the user has pressed the control.
  bool note(std::string_view name) {
    names.emplace_back(name);
    return name == pressed;
  }
};

} // namespace nendo::test
