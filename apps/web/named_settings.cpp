#include "web/named_settings.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::web {
namespace {

/// One length for all fingers, or five with commas between.
std::optional<std::array<double, 5>> lengths_in(std::string_view text) noexcept {
  std::array<double, 5> lengths{};
  const bool one_for_all = text.find(',') == std::string_view::npos;
  std::string_view rest = text;
  for (double& length : lengths) {
    const auto number = to_finite_number(one_for_all ? text : cut(rest, ','));
    if (!number) return std::nullopt;
    length = *number;
  }
  if (!one_for_all && (!rest.empty() || text.ends_with(','))) return std::nullopt;
  return lengths;
}

std::optional<bool> truth_named(std::string_view text) noexcept {
  if (text == "true") return true;
  if (text == "false") return false;
  return std::nullopt;
}

/// Reads the value of a setting by its kind. Returns what can be used if the text is no such value;
/// empty: it was read. Ranges are checked later, because the description knows them.
struct ValueReader {
  std::string_view text;
  flow::LoopSettings& settings;

  template <class T>
  std::string operator()(const flow::ChoiceSetting<T>& choice) const {
    return put(choice.named(text), choice.of(settings), choice.choices);
  }
  std::string operator()(const flow::SwitchSetting& on) const {
    return put(truth_named(text), on.of(settings), "true or false");
  }
  std::string operator()(const flow::NumberSetting& number) const {
    return put(to_finite_number(text), number.of(settings), "a number");
  }
  std::string operator()(const flow::FingersSetting& fingers) const {
    return put(lengths_in(text), fingers.of(settings),
               "metres, or five numbers with commas between");
  }
  std::string operator()(const flow::BrushesSetting& brushes) const {
    const auto parsed = flow::parse_brushes(text);
    if (!parsed) return deform::brush_words() + ", or five with commas between";
    brushes.of(settings) = *parsed;
    return {};
  }

private:
  template <class T>
  static std::string put(const std::optional<T>& value, T& place, std::string_view usable) {
    if (!value) return std::string(usable);
    place = *value;
    return {};
  }
};

struct ValueText {
  const flow::LoopSettings& settings;

  template <class T>
  std::string operator()(const flow::ChoiceSetting<T>& choice) const {
    return std::string(choice.name_of(choice.of(settings)));
  }
  std::string operator()(const flow::SwitchSetting& on) const {
    return on.of(settings) ? "true" : "false";
  }
  std::string operator()(const flow::NumberSetting& number) const {
    return decimal_text(number.of(settings));
  }
  std::string operator()(const flow::FingersSetting& fingers) const {
    std::string text;
    for (const double length : fingers.of(settings))
      text += (text.empty() ? "" : ",") + decimal_text(length);
    return text;
  }
  std::string operator()(const flow::BrushesSetting& brushes) const {
    return flow::in_words(brushes.of(settings));
  }
};

/// Takes the value of one setting. Returns why it is refused; empty: it was taken.
std::string take(std::string_view name, std::string_view value, NamedSettings& named) {
  std::string why;
  bool is_known = false;
  std::uint32_t bit = 1;
  flow::for_each_setting([&](const auto& setting) {
    const std::uint32_t own = std::exchange(bit, bit << 1U);
    if (setting.name != name) return;
    is_known = true;
    if ((named.named & own) != 0)
      why = std::string(name) + " stands twice; name each setting once";
    else if (const auto usable = ValueReader{value, named.values}(setting); !usable.empty())
      why = std::string(name) + ": use " + usable;
    named.named |= own;
  });
  if (is_known) return why;
  return "there is no setting " + in_quotes(name) + "; message 4 names all settings";
}

} // namespace

void NamedSettings::apply_to(flow::LoopSettings& settings) const noexcept {
  std::uint32_t bits = named;
  flow::for_each_setting([&](const auto& setting) {
    if ((std::exchange(bits, bits >> 1U) & 1U) != 0) setting.of(settings) = setting.of(values);
  });
}

Result<NamedSettings> parse_named_settings(std::string_view text) {
  NamedSettings named;
  named.values.radius_m.fill(1.0); // usable, also if the text does not name them
  std::string why;
  if (text.empty() || text.ends_with(' '))
    why = "settings: write NAME=VALUE, with single spaces between, as in mode=type2";
  while (why.empty() && !text.empty()) {
    std::string_view value = cut(text, ' ');
    const std::string_view name = cut(value, '=');
    why = take(name, value, named);
  }
  if (!why.empty()) return Error{Errc::bad_input, why};
  if (auto checked = flow::check_ranges(named.values); !checked) return checked.error();
  return named;
}

std::string text_of(const flow::LoopSettings& settings) {
  std::string text;
  flow::for_each_setting([&](const auto& setting) {
    text +=
        (text.empty() ? "" : " ") + std::string(setting.name) + '=' + ValueText{settings}(setting);
  });
  return text;
}

} // namespace nendo::web
