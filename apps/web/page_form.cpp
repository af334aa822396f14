#include "web/page_form.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

namespace nendo::web {
namespace {

constexpr const char* look_names[] = {"", "chosen", "grey", "done"};
constexpr const char* tone_names[] = {"", "faint", "warning", "success", "title"};
constexpr std::chrono::milliseconds held_for(1200); ///< how long a number is changing

} // namespace

void PageForm::begin(std::optional<FormInput> input) {
  parts_ = Json::array();
  same_.clear();
  input_ = std::move(input);
  forget_drawings();
}

const commands::Row* PageForm::take_edit_command() {
  if (!input_ || input_->pointer || !input_->value.empty()) return nullptr;
  const auto* const row = commands::named(input_->control);
  if (row == nullptr || !row->edit) return nullptr;
  input_.reset();
  return row;
}

void PageForm::part(std::string_view name) {
  parts_.push_back({{"name", name}, {"controls", Json::array()}});
  in_line_ = 1;
}

std::string PageForm::message(std::string_view screen) const {
  Json whole;
  if (!screen.empty()) whole["screen"] = screen;
  whole["parts"] = parts_;
  return whole.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PageForm::Json PageForm::control(const char* kind, std::string_view name, std::string_view help) {
  const int before = same_[std::string(name)]++;
  std::string id(name);
  if (before > 0) id += '#' + std::to_string(before);
  return {{"kind", kind}, {"id", std::move(id)}, {"name", name}, {"help", help}};
}

void PageForm::add(Json control) {
  parts_.back()["controls"].push_back(std::move(control));
}

std::optional<FormInput> PageForm::taken(Json control) {
  const bool is_meant = input_ && control["id"] == input_->control;
  add(std::move(control));
  if (!is_meant) return std::nullopt;
  return std::exchange(input_, std::nullopt);
}

std::optional<std::string> PageForm::changed(Json control) {
  auto given = taken(std::move(control));
  if (!given || given->pointer) return std::nullopt;
  return std::move(given->value);
}

std::optional<std::size_t> PageForm::chosen_of(Json control, std::size_t count) {
  const auto given = changed(std::move(control));
  const auto number = given ? to_integer(*given) : std::nullopt;
  if (!number || *number < 0 || static_cast<std::uint64_t>(*number) >= count) return std::nullopt;
  return static_cast<std::size_t>(*number);
}

void PageForm::separator() {
  in_line_ = 1;
  add({{"kind", "separator"}});
}

void PageForm::text(std::string_view words, Tone tone, std::string_view help) {
  Json one{{"kind", "text"}, {"name", words}, {"look", tone_names[static_cast<std::size_t>(tone)]}};
  if (!help.empty()) one["help"] = help;
  add(std::move(one));
}

void PageForm::key(std::string_view words, const Eigen::Vector3f& colour) {
  add({{"kind", "key"}, {"name", words}, {"colour", {colour.x(), colour.y(), colour.z()}}});
}

void PageForm::ring(double share, bool warns) {
  add({{"kind", "ring"},
       {"name", ""},
       {"value", std::round(100.0 * share)},
       {"look", warns ? "warning" : "success"}});
}

void PageForm::title(std::string_view words, std::string_view note) {
  add({{"kind", "title"}, {"name", words}, {"note", note}});
}

bool PageForm::section(std::string_view name, std::string_view help, bool is_open_at_first) {
  in_line_ = 1;
  Json one = control("section", name, help);
  one["open"] = is_open_at_first;
  add(std::move(one));
  return true;
}

void PageForm::chart(std::string_view name, std::string_view help, std::span<const float>) {
  add(control("chart", name, help));
}

void PageForm::bends(Side side, std::string_view help, std::span<const float>) {
  add(control("bars", name_of(side), help));
}

void PageForm::file(std::string_view name, std::string_view help) {
  add(control("file", name, help));
}

bool PageForm::button(std::string_view name, std::string_view help, Look look) {
  Json one = control("button", name, help);
  one["share"] = in_line_;
  one["look"] = look_names[static_cast<std::size_t>(look)];
  return changed(std::move(one)) && look != Look::grey;
}

bool PageForm::card(std::string_view name, const render::Image* picture, std::string_view help,
                    bool is_chosen) {
  Json one = control("button", name, help);
  one["share"] = in_line_;
  one["look"] = is_chosen ? "chosen" : "";
  one["picture"] = nullptr;
  if (picture != nullptr) one["picture"] = number_of(*picture);
  return changed(std::move(one)).has_value();
}

PageForm::Json PageForm::control_of(const char* kind, std::string_view name,
                                    const commands::Row& row, const commands::State& now) const {
  const bool is_possible = row.refusal_in(now) == nullptr;
  return {{"kind", kind},      {"id", row.name},
          {"name", name},      {"help", commands::help_of(row, now)},
          {"share", in_line_}, {"look", !is_possible ? "grey" : row.is_on_in(now) ? "on" : ""}};
}

bool PageForm::command(const commands::Row& row, const commands::State& now) {
  const bool is_on = row.is_on_in(now) && !row.button_on.empty();
  add(control_of("command", is_on ? row.button_on : row.button, row, now));
  return false;
}

/// Pages themselves know which of their own commands are on.
bool PageForm::box(std::string_view name, const commands::Row& row, const commands::State& now,
                   bool is_on) {
  Json one = control_of("box", name, row, now);
  one["value"] = nullptr;
  if (row.is_for_run()) one["value"] = is_on;
  add(std::move(one));
  return false;
}

bool PageForm::one_of(std::string_view name, std::span<const Choice> choices, std::size_t& chosen) {
  Json one = control("radio", name, "");
  one["share"] = in_line_;
  one["value"] = chosen;
  one["choices"] = Json::array();
  for (const Choice& choice : choices)
    one["choices"].push_back(
        {{"name", choice.name}, {"help", choice.help}, {"picture", choice.picture}});
  const auto given = chosen_of(std::move(one), choices.size());
  chosen = given.value_or(chosen);
  return given.has_value();
}

std::optional<std::size_t> PageForm::list(std::string_view name, std::string_view help,
                                          std::span<const Row> rows, std::size_t present) {
  Json one = control("list", name, help);
  one["value"] = present;
  one["rows"] = Json::array();
  for (const Row& row : rows)
    one["rows"].push_back({{"name", row.text}, {"look", row.is_faint ? "faint" : ""}});
  return chosen_of(std::move(one), rows.size());
}

bool PageForm::check(std::string_view name, std::string_view help, bool& value) {
  Json one = control("check", name, help);
  one["value"] = value;
  const auto given = changed(std::move(one));
  if (!given || (*given == "true") == value) return false;
  value = !value;
  return true;
}

bool PageForm::choice(std::string_view name, std::string_view help,
                      std::span<const std::string_view> names, std::size_t& chosen) {
  Json one = control("choice", name, help);
  one["value"] = names[chosen];
  one["choices"] = names;
  const auto given = changed(std::move(one));
  const auto found = given ? std::ranges::find(names, *given) : names.end();
  if (found == names.end()) return false;
  chosen = static_cast<std::size_t>(found - names.begin());
  return true;
}

bool PageForm::number(std::string_view name, std::string_view help, float& value, float min,
                      float max, std::string_view unit, int decimals) {
  Json one = control("number", name, help);
  one["value"] = value; // a page rounds it
  one["min"] = min;
  one["max"] = max;
  one["unit"] = unit;
  one["decimals"] = decimals;
  const auto given = changed(std::move(one));
  const auto number = given ? to_finite_number(*given) : std::nullopt;
  if (!number) return false;
  number_changed_ = HostClock::now(); // also by the same value, of a slider that is held
  const float before = std::exchange(value, std::clamp(static_cast<float>(*number), min, max));
  return value != before;
}

bool PageForm::line(std::string_view name, std::string& value) {
  Json one = control("line", name, {});
  one["value"] = value;
  const auto given = changed(std::move(one));
  if (!given) return false;
  value = *given;
  return true;
}

bool PageForm::is_changing() const {
  return HostClock::now() - number_changed_ < held_for;
}

} // namespace nendo::web
