// The description of the settings: it has each once, and what is made from it agrees.

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>

#include <doctest/doctest.h>

#include <nendo/flow/setting.hpp>

namespace setting_test {

using namespace nendo;
using flow::LoopSettings;

namespace {

LoopSettings usable() {
  LoopSettings settings;
  settings.radius_m.fill(0.1);
  return settings;
}

/// Changes a setting to another value.
struct Change {
  LoopSettings& settings;

  void operator()(const flow::SwitchSetting& on) const { on.of(settings) = !on.of(settings); }
  void operator()(const flow::NumberSetting& number) const {
    number.of(settings) = number.range.max;
  }
  void operator()(const flow::FingersSetting& lengths) const { lengths.of(settings)[3] = 0.2; }
  void operator()(const flow::BrushesSetting& brushes) const {
    brushes.of(settings)[2] = deform::Brush::twist;
  }
  template <class T>
  void operator()(const flow::ChoiceSetting<T>& choice) const {
    choice.of(settings) = choice.of(settings) == T{} ? static_cast<T>(1) : T{};
  }
};

} // namespace

TEST_SUITE("setting") {
  TEST_CASE("each setting has names of its own, and is its member alone") {
    std::set<std::string_view> names, options;
    LoopSettings all = usable();
    flow::for_each_setting([&](const auto& setting) {
      CAPTURE(setting.name);
      CHECK(names.insert(setting.name).second);
      if (!setting.option.empty()) CHECK(options.insert(setting.option).second);
      CHECK_FALSE(setting.words.empty());
      CHECK_FALSE(setting.label.empty());
      CHECK(setting.help.empty() == setting.option.empty());
      LoopSettings changed = usable();
      Change{changed}(setting);
      CHECK(changed != usable());
      CHECK(kind_of_change(usable(), changed) == setting.step);
      setting.of(changed) = setting.of(usable());
      CHECK(changed == usable());
      Change{all}(setting);
    });
    CHECK(names.size() == 14); // as many as LoopSettings has, and its filter
    CHECK(kind_of_change(usable(), all) == flow::StepKind::settings);
  }

  TEST_CASE("all choices have names that are read back and are in messages") {
    flow::for_each_setting([](const auto& setting) {
      if constexpr (requires { setting.named; }) {
        const auto names = setting.names();
        CHECK(names.size() > 1);
        for (std::size_t number = 0; number < names.size(); ++number) {
          const auto choice = static_cast<std::decay_t<decltype(setting.of(usable()))>>(number);
          CHECK(setting.named(names[number]) == choice);
          CHECK(setting.name_of(choice) == names[number]);
        }
      }
    });
  }

  TEST_CASE("settings are read from text, and what is no value is refused with what is one") {
    LoopSettings settings = usable();
    for (const auto& [name, value] : {std::pair{"mode", "clay"},
                                      {"injective", "true"},
                                      {"keep_volume", "0.25"},
                                      {"radius_m", "0.01,0.02,0.03,0.04,0.05"},
                                      {"brushes", "twist"},
                                      {"filter", "one-euro"}})
      CHECK(flow::set_from_text(settings, name, value));
    CHECK(settings.mode == flow::Mode::clay);
    CHECK(settings.injective);
    CHECK(settings.keep_volume == 0.25);
    CHECK(settings.radius_m == std::array{0.01, 0.02, 0.03, 0.04, 0.05});
    CHECK(settings.brushes[4] == deform::Brush::twist);
    CHECK(settings.filter.kind == hand::FilterKind::one_euro);
    const LoopSettings before = settings;
    const auto refusal = [&](const char* name, const char* value) {
      const auto set = flow::set_from_text(settings, name, value);
      CHECK(settings == before);
      return set ? std::string() : set.error().message;
    };
    CHECK(refusal("mode", "Clay") == "mode: use type1, type2, clay or parts");
    CHECK(refusal("injective", "yes") == "injective: use true or false");
    CHECK(refusal("keep_volume", "nan") == "keep_volume: use a number");
    const char* const lengths = "radius_m: use metres, or five numbers with commas between";
    for (const char* wrong : {"", "x", "1,2", "1,2,3,4,", "1,2,3,4,5,", "1,2,3,4,5,6"})
      CHECK(refusal("radius_m", wrong) == lengths);
    CHECK(refusal("brushes", "dig").ends_with("scale or pinch, or five with commas between"));
    CHECK(refusal("co\x1blour", "red").starts_with("co?lour: no such setting; use mode, kernel, "));
    CHECK(flow::set_from_text(settings, "radius_m", "0.5"));
    CHECK(settings.radius_m == std::array{0.5, 0.5, 0.5, 0.5, 0.5});
  }

  TEST_CASE("the help of the brushes names each of them") {
    for (std::uint8_t number = 0; number < deform::brush_count; ++number)
      CHECK(flow::setting::brushes.help.find(name_of(static_cast<deform::Brush>(number))) !=
            std::string_view::npos);
  }

  TEST_CASE("a number that others give an effect has none by itself, and its option a remedy") {
    flow::for_each_setting([](const auto& setting) {
      if constexpr (requires { setting.has_effect; }) {
        CAPTURE(setting.name);
        if (setting.has_effect == nullptr) return;
        CHECK_FALSE(setting.has_effect(flow::usual_settings()));
        CHECK(setting.remedy.empty() == setting.option.empty());
      }
    });
    LoopSettings settings = usable();
    settings.filter.kind = hand::FilterKind::one_euro;
    CHECK(flow::setting::beta.has_effect(settings));
    settings.brushes[3] = deform::Brush::inflate;
    CHECK(flow::setting::brush_strength.has_effect(settings));
  }

  TEST_CASE("a range is written with its unit") {
    CHECK(flow::in_words(flow::setting::min_cutoff.range, flow::setting::min_cutoff.unit) ==
          "0.01 to 1000 Hz");
    CHECK(flow::in_words(flow::setting::brush_strength.range, "") == "-1 to 1");
  }

  TEST_CASE("what is out of its range is named, with the range") {
    CHECK(flow::check_ranges(usable()));
    CHECK(usable().are_usable());
    flow::for_each_setting([](const auto& setting) {
      if constexpr (requires { setting.range; }) {
        for (const double wrong : {setting.range.min - 1.0, 2.0 * setting.range.max,
                                   std::numeric_limits<double>::quiet_NaN()}) {
          LoopSettings settings = usable();
          if constexpr (requires { setting.of(settings)[0]; })
            setting.of(settings)[4] = wrong;
          else
            setting.of(settings) = wrong;
          CHECK_FALSE(settings.are_usable());
          const auto fine = flow::check_ranges(settings);
          REQUIRE_FALSE(fine);
          CHECK(fine.error().message.starts_with(setting.name));
        }
      }
    });
    LoopSettings settings = usable();
    settings.keep_volume = 1.5;
    CHECK(flow::check_ranges(settings).error().message == "keep_volume: use 0 to 1");
    settings = usable();
    settings.radius_m[2] = 0.0;
    CHECK(flow::check_ranges(settings).error().message == "radius_m: use 1e-09 to 1e+09 m");
  }

  TEST_CASE("settings are printed in one way, radii on the stage and in the model's units") {
    LoopSettings settings = usable();
    CHECK(in_words(settings, 2.5) == "type1, wendland-c2, may fold, radius 10 cm (0.25)");
    settings.mode = flow::Mode::type2;
    settings.brushes.fill(deform::Brush::inflate);
    settings.injective = true;
    settings.radius_m[1] = 0.132;
    CHECK(in_words(settings, 1000.0) == "type2, inflate at strength 0.5, wendland-c2, never folds, "
                                        "radius 10 to 13.2 cm (100 to 132)");
    settings.mode = flow::Mode::type1;
    settings.hold = flow::Hold::hand;
    settings.keep_volume = 0.75;
    CHECK(in_words(settings, 1.0) == "type1, whole hand, wendland-c2, 0.75 of clay, radius 10 to "
                                     "13.2 cm (0.1 to 0.132)");
  }
}

} // namespace setting_test
