#pragma once
// The panel of a run, in the window and on the page: its controls, in their order. One thread.

#include <array>
#include <string>
#include <vector>

#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>

#include "commands/commands.hpp"
#include "forms/form.hpp"
#include "forms/setting_form.hpp"

namespace nendo::forms {

/// Lines about the devices of each hand, by flow::Placement::index_of(side).
using DeviceLines = std::array<std::vector<std::string>, 2>;

/// The latest values of a quantity in milliseconds, the newest last.
struct Strip : std::array<float, 240> {
  void add(float value) noexcept;
};

class RunPanel {
public:
  /// `place`: commands::in_window or commands::on_page.
  explicit RunPanel(std::uint8_t place) noexcept : settings_(place), place_(place) {}
  virtual ~RunPanel() = default;

  flow::PendingSettings pending;
  std::vector<flow::Command> commands; ///< asked for and not taken yet, in their order
  std::string note;                    ///< why the last command was refused; empty: it was not
  Strip late_ms{}, uneven_ms{}, pictures_ms{}; ///< pages have their own

  /// Asks for what a row of the run does.
  void ask(const commands::Row& row, const commands::Situation& now);

protected:
  /// Describes all controls. What the user did to them becomes `commands` and `pending`.
  void describe(Form& form, const commands::Situation& now, const DeviceLines& devices);
  /// Lists the history's steps. A click undoes or redoes up to a step.
  void describe_history(Form& form, const flow::Frame& frame);

private:
  /// Buttons of a group, two per line.
  void buttons_of(Form& form, commands::Buttons group, const commands::Situation& now);
  void box(Form& form, std::string_view name, const commands::Row& row,
           const commands::Situation& now);
  void describe_masks(Form& form, const commands::Situation& now);
  void describe_view(Form& form, const commands::Situation& now);
  void describe_timing(Form& form, const flow::Frame& frame) const;
  void go_to_step(const flow::StepList& list, std::size_t at);

  // The parts that windows and pages have by themselves:

  /// Returns whether the panel lists the history, and not the window beside it.
  virtual bool has_history() const { return true; }
  /// Returns whether the puppet is edited, and so is first.
  virtual bool edits_puppet() const { return false; }
  virtual void describe_puppet(Form& form, const flow::Frame& frame) = 0;
  /// Adds controls to those of the view, and of masks.
  virtual void describe_look(Form& form, const commands::Situation& now) {
    static_cast<void>(form), static_cast<void>(now);
  }
  virtual void describe_painting(Form& form) { static_cast<void>(form); }
  /// Returns whether a command is on that the run does not execute, and executes one.
  virtual bool is_on(const commands::Row& row) const { return static_cast<void>(row), false; }
  virtual void execute(const commands::Row& row) { static_cast<void>(row); }

  SettingForm settings_;
  std::uint8_t place_;
};

} // namespace nendo::forms
