// The panel of a run as a message for pages.

#include <map>
#include <set>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/flow/setting.hpp>

#include "web/page_panel.hpp"

namespace page_panel_test {

using namespace nendo;
using namespace nendo::web;
using Json = nlohmann::json;

/// A run, whose loop does what is asked for, and the page of its user.
struct Run {
  PagePanel panel;
  flow::Frame frame;
  commands::RunFacts facts;
  forms::DeviceLines devices;

  Run() {
    frame.settings.radius_m.fill(0.1);
    panel.pending.follow(frame.settings);
  }
  /// Returns the controls by their ids, after an input.
  std::map<std::string, Json> controls(std::optional<FormInput> input = {}) {
    panel.follow(std::move(input), {frame, facts}, devices, nullptr);
    const Json message = Json::parse(panel.message());
    std::map<std::string, Json> all;
    for (const Json& one : message.at("parts").at(0).at("controls"))
      if (one.contains("id")) CHECK(all.emplace(one["id"], one).second);
    return all;
  }
  const flow::LoopSettings& after(const std::string& control, const std::string& value) {
    controls(FormInput{control, value, FormKind::run});
    return panel.pending.now;
  }
};

TEST_SUITE("page_panel") {
  TEST_CASE("a mode has the settings that work in it, and no other") {
    Run run;
    const auto names_in = [&](flow::Mode mode) {
      run.panel.pending.now.mode = mode;
      const auto controls = run.controls();
      std::set<std::string> names;
      for (const std::string name : {"radius", "kernel", "brush", "whole hand", "never folds",
                                     "volume", "closed pinches", "smooth hands"})
        if (controls.contains(name)) names.insert(name);
      return names;
    };
    using Names = std::set<std::string>;
    CHECK(names_in(flow::Mode::type1) == Names{"radius", "kernel", "whole hand", "never folds",
                                               "volume", "closed pinches", "smooth hands"});
    CHECK(names_in(flow::Mode::type2) == Names{"radius", "kernel", "brush", "never folds", "volume",
                                               "closed pinches", "smooth hands"});
    CHECK(names_in(flow::Mode::clay) == Names{"smooth hands"});
  }

  TEST_CASE("each setting that has an option has a control in each mode where it works") {
    Run run;
    auto& now = run.panel.pending.now;
    now.brushes.fill(deform::Brush::inflate); // so that their strength has an effect
    now.filter.kind = hand::FilterKind::one_euro;
    for (std::size_t number = 0; number < flow::mode_count; ++number) {
      now.mode = static_cast<flow::Mode>(number);
      const auto controls = run.controls();
      flow::for_each_setting([&](const auto& setting) {
        CAPTURE(setting.name);
        const bool is_there = controls.contains(std::string(setting.label));
        CHECK(is_there == (setting.works_in(now.mode) && !setting.option.empty()));
      });
    }
  }

  TEST_CASE("an input changes its setting, and no input makes one that is not allowed") {
    Run run;
    for (const auto& [text, radius_m] : {std::pair{"12.5", 0.125},
                                         {"1e9", 0.4},
                                         {"-3", 0.01},
                                         {"nan", 0.01},
                                         {"", 0.01},
                                         {"8", 0.08}}) {
      const std::string value(text); // Clang 14 captures no structured binding
      CAPTURE(value);
      for (const double one : run.after("radius", value).radius_m)
        CHECK(one == doctest::Approx(radius_m));
    }
    CHECK(run.after("mode", "1").mode == flow::Mode::type2);
    CHECK(run.after("mode", "99").mode == flow::Mode::type2);
    CHECK(run.after("mode", "-1").mode == flow::Mode::type2);
    CHECK(run.after("mode", "Clay").mode == flow::Mode::type2);
    CHECK(run.after("kernel", "0").kernel == deform::Wendland::c0);
    CHECK(run.after("never folds", "true").injective);
    CHECK(run.after("volume", "0.254").keep_volume == 0.25);
    CHECK(run.after("no such control", "1").keep_volume == 0.25);
    CHECK(run.panel.commands.empty()); // settings are one command, which their owner asks for
    CHECK(run.panel.pending.ask().has_value());
    CHECK_FALSE(run.panel.pending.ask());
  }

  TEST_CASE("one radius, or brush, becomes five, of which each is its own") {
    Run run;
    run.after("mode", "1");
    CHECK_FALSE(run.controls().contains("little"));
    run.after("one radius for all fingers", "false");
    run.after("one brush for all fingers", "false");
    const auto& chosen = run.after("little", "5");
    CHECK(chosen.radius_m[4] == doctest::Approx(0.05));
    CHECK(chosen.radius_m[0] == doctest::Approx(0.1));
    CHECK(run.after("thumb#1", "inflate").brushes[0] == deform::Brush::inflate);
    CHECK(chosen.brushes[1] == deform::Brush::pull);
    CHECK(run.controls().contains("strength"));
    run.panel.pending.now.radius_m[1] = 0.3; // by a client that has no panel
    run.after("one radius for all fingers", "true");
    CHECK(chosen.radius_m[4] == doctest::Approx(0.1));
    run.panel.pending.now.radius_m[1] = 0.3;
    CHECK(run.controls().contains("little")); // and the radius stays as it is
    CHECK(chosen.radius_m[1] == 0.3);
  }

  TEST_CASE("a click on a step asks for the undos or redos between") {
    Run run;
    run.frame.steps.count = 3;
    run.frame.steps.undoable = 2;
    const auto asked = [&](const std::string& step) {
      run.panel.commands.clear();
      run.after("step", step);
      return run.panel.commands;
    };
    using flow::Request;
    using Commands = std::vector<flow::Command>;
    CHECK(asked("0") == Commands{Request::undo, Request::undo});
    CHECK(asked("2").empty());
    CHECK(asked("3") == Commands{Request::redo});
    CHECK(asked("4").empty());
    const auto list = run.controls().at("step");
    CHECK(list["value"] == 2);
    CHECK(list["rows"].size() == 4);
    CHECK(list["rows"][2]["look"] == "");
    CHECK(list["rows"][3]["look"] == "faint");
  }

  TEST_CASE("a command that is not possible is grey and says why, and one that is on says so") {
    Run run;
    auto controls = run.controls();
    CHECK(controls.at("undo")["look"] == "grey");
    const std::string help = controls.at("undo")["help"];
    CHECK(help.find('\n') != std::string::npos);
    CHECK(help.ends_with("(u, Ctrl Z)"));
    CHECK(controls.at("take")["name"] != "End recording");
    run.facts.recorded = true;
    controls = run.controls();
    CHECK(controls.at("take")["name"] == "End recording");
    CHECK(controls.at("take")["look"] == "on");
    CHECK(controls.at("symmetry")["value"] == false);
    CHECK(controls.at("paint masks")["value"].is_null()); // pages know
    CHECK(controls.at("show hands")["name"] == "hands");
  }

  TEST_CASE("a page that presses what it executes itself changes nothing here") {
    Run run;
    for (const auto* const name : {"grab", "symmetry", "paint masks", "show hands"})
      run.after(name, "");
    CHECK(run.panel.commands.empty());
  }

  TEST_CASE("the status bar says what the loop does, in words with help") {
    flow::Frame frame;
    frame.held = false;
    frame.ticks_run = 12345;
    frame.missed = 2;
    const Json message = Json::parse(status_message(frame, 100.0, 100352));
    std::vector<std::string> words;
    for (const Json& one : message["parts"][0]["controls"]) {
      words.push_back(one["name"]);
      CHECK_FALSE(std::string(one["help"]).empty());
    }
    REQUIRE(words.size() == 3);
    CHECK(words[0] == "holds nothing");
    CHECK(words[1] == "100,352 vertices");
    CHECK(words[2] == "100 Hz, 2 of 12,345 missed");
  }
}

} // namespace page_panel_test
